# Lets this shell use the build in ./build without installing it: to be sourced,
#   . pipelines/environment.sh
# CLOTH_BUILD names another build folder. In a shell that doesn't tell a sourced file where it
# is, as dash, be in the project's folder.
# SPDX-License-Identifier: LGPL-2.1-or-later

if [ -n "${BASH_SOURCE:-}${ZSH_VERSION:-}" ]; then
  cloth_root=$(cd "$(dirname "${BASH_SOURCE:-$0}")/.." && pwd)
elif [ -f pipelines/environment.sh ]; then
  cloth_root=$PWD
else
  echo "environment.sh: this shell doesn't tell where the file is: cd to the folder of the" \
      "project first, or use bash" >&2
  return 1
fi
cloth_build=${CLOTH_BUILD:-$cloth_root/build}
if ! [ -e "$cloth_build/elements/libgstcloth.so" ]; then
  echo "environment.sh: there is no build in $cloth_build: run $cloth_root/pipelines/quickstart.sh," \
      "or set CLOTH_BUILD to a build" >&2
  unset cloth_root cloth_build
  return 1
fi

export GST_PLUGIN_PATH_1_0="$cloth_build/elements${GST_PLUGIN_PATH_1_0:+:$GST_PLUGIN_PATH_1_0}"
export GI_TYPELIB_PATH="$cloth_build/gst/cloth${GI_TYPELIB_PATH:+:$GI_TYPELIB_PATH}"
export LD_LIBRARY_PATH="$cloth_build/gst/cloth${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
export PKG_CONFIG_PATH="$cloth_build/meson-uninstalled${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH}"
# what stands behind the last colon is the system's
export MANPATH="$cloth_build/tools:${MANPATH:-}"
export PATH="$cloth_build/tools:$PATH"
unset cloth_root cloth_build
