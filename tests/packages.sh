# Installs the packages of tests/packages.txt that are missing, and sets up the build
# folder: to be sourced.
# SPDX-License-Identifier: LGPL-2.1-or-later

# cloth_packages: the names, one a line.
cloth_packages ()
{
  sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' "$1/tests/packages.txt"
}

# cloth_install_packages ROOT [PACKAGE...]: those of the list and these; leaves apt alone when
# nothing is missing.
cloth_install_packages ()
{
  local missing="" package status as_root="" root=$1

  shift
  for package in $(cloth_packages "$root") "$@"; do
    status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) || true
    [ "$status" = installed ] || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0

  if [ "$(id -u)" -ne 0 ]; then
    as_root="sudo"
    command -v sudo >/dev/null || {
      echo "Missing packages:$missing. Install them as root, or install sudo." >&2
      return 1
    }
  fi
  echo "Installing:$missing"
  $as_root apt-get update -q </dev/null || return 1
  # shellcheck disable=SC2086
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q \
      --no-install-recommends $missing </dev/null
}

# cloth_set_up_build [OPTION...]: sets up ./build, with these options when it is new. A
# folder of meson's that another checkout or an aborted set-up left is made anew.
cloth_set_up_build ()
{
  if [ -d build/meson-private ]; then
    meson setup --reconfigure build && return 0
    rm -rf build
  fi
  meson setup build "$@"
}
