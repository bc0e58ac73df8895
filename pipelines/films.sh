# What the scripts that go from films to meshes have in common: to be sourced.
# SPDX-License-Identifier: LGPL-2.1-or-later

heading () { printf '\n== %s\n' "$*"; }

# With -q gst-launch would keep warnings to itself, and they say which camera is off or that
# the print is another one.
launch () {
  gst-launch-1.0 "$@" | sed -u -e '/^Setting pipeline/d' -e '/^Pipeline is/d' \
      -e '/^New clock/d' -e '/^Redistribute latency/d' -e '/^Got EOS/d' \
      -e '/^Execution ended/d' -e '/^Freeing pipeline/d' -e '/^Use Windows/d' \
      -e '/^Additional debug info/d' -e '/^\.\..*\.c([0-9]*):/d'
}

# Between a decoder and what looks at its pictures: films of phones in portrait are stored turned,
# and say so.
# shellcheck disable=SC2034
upright=(! videoconvert ! videoflip video-direction=auto)

# Whether a take says where anything is: of each vertex in each frame one byte, 0 for unseen,
# after a header of 128.
any_located () {
  [ "$(tail -c +129 "$1/states.npy" | tr -d '\0' | wc -c)" != 0 ]
}
