#!/bin/bash
# From a fresh Debian 12 to films, meshes and a table of errors, with the data that is
# shipped: installs packages, builds, calibrates a real stereo pair, then tracks and
# triangulates a cloth filmed by two cameras.
#
#   pipelines/quickstart.sh [OUTPUT-FOLDER]      (default: cloth-quickstart)
#
# CLOTH_BUILD names a finished build to use instead of making one in ./build.
# SPDX-License-Identifier: LGPL-2.1-or-later
set -euo pipefail
here=$PWD
root=$(cd "$(dirname "$0")/.." && pwd)
out=${1:-$here/cloth-quickstart}
export LC_ALL=C.UTF-8

heading () { printf '\n== %s\n' "$*"; }

if [ -z "${CLOTH_BUILD:-}" ]; then
  heading "Packages"
  . "$root/tests/packages.sh"
  cloth_install_packages "$root"
  heading "Build"
  cd "$root"
  [ -f build/build.ninja ] || meson setup build --buildtype=release
  ninja -C build
  cd "$here"
fi
. "$root/pipelines/environment.sh"

started=$(date +%s)
mkdir -p "$out"
out=$(cd "$out" && pwd)
boards=$root/tests/data/opencv_boards
pair=$root/tests/data/checker_pair

heading "Real pictures: calibration of a stereo pair from a board"
gst-cloth-calibrate-1.0 --pattern "$boards/pattern.json" \
    --camera "left=$boards/left*.jpg" --camera "right=$boards/right*.jpg" \
    --output "$out/boards-rig.json"

heading "Real pictures: the corners found in them"
mkdir -p "$out/boards"
for picture in "$boards"/{left,right}??.jpg; do
  gst-launch-1.0 -q filesrc location="$picture" ! jpegdec \
      ! video/x-raw,format=GRAY8 ! saledetect_placeholder
done

heading "Rendered film: two cameras to a mesh, and the overlay"
