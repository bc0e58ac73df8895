#!/bin/bash
# From films of a cloth with any print to its animated mesh: matches the films with the picture
# of the flat cloth, finds where the vertices of its grid are in space, fills the holes, and
# lays a check over the first film, which shows wherever the mesh slips.
#
#   pipelines/print-to-mesh.sh RIG PATTERN OUTPUT CAMERA=FILM CAMERA=FILM...
#   pipelines/print-to-mesh.sh RIG PATTERN OUTPUT [near=METRES] [far=METRES]
#       CAMERA=FILM,CAMERA=FILM[,CAMERA=FILM]...
#
# RIG is the rig.json, PATTERN the pattern.json of kind "picture", OUTPUT the folder that is
# filled, each CAMERA a name in the rig. Films of one rig start together. Cameras by themselves
# are triangulated. Two or three joined by commas are a stereo head, whose first camera is
# matched and whose others give it depth: the cloth is between near and far, and all else farther.
# SPDX-License-Identifier: LGPL-2.1-or-later
set -euo pipefail
usage () {
  sed -n 's/^#   //p' "$0" >&2
  exit 2
}
[ $# -ge 4 ] || usage
. "$(dirname "$0")/environment.sh"
. "$(dirname "$0")/films.sh" # pipelines/films.sh
rig=$1 pattern=$2 out=$3
shift 3
depths=()
while [[ ${1-} = near=* || ${1-} = far=* ]]; do
  depths+=("$1")
  shift
done
[ $# -ge 1 ] || usage
# near and far are of stereo heads
[[ $1 = *,* || ( $# -ge 2 && ${#depths[@]} = 0 ) ]] || usage

# Adds the film CAMERA=FILE to the graph up to the elements that follow; the first film tells
# how far all are.
films=()
progress=(! progressreport name=filmed update-freq=2)
add_film () {
  camera=${1%%=*} file=${1#*=}
  if [ "$camera" = "$1" ] || [ ! -f "$file" ]; then
    echo "$1: no film; write CAMERA=FILE" >&2
    exit 2
  fi
  films+=(filesrc "location=$file" ! decodebin "${progress[@]}" "${upright[@]}"
      ! videoconvert ! video/x-raw,format=GRAY8)
  progress=()
}

first=${1%%,*}
if [[ $1 = *,* ]]; then
  join=(uvmap name=join "pattern=$pattern")
  head=0
  for cameras in "$@"; do
    IFS=, read -r -a own <<<"$cameras"
    depth=(clothdisparity "name=head$head" "rig=$rig" "${depths[@]}")
    for k in "${!own[@]}"; do
      add_film "${own[k]}"
      films+=(! queue ! "head$head.sink_$k")
      depth+=("sink_$k::camera=$camera")
    done
    films+=("${depth[@]}" ! siftmatch "pattern=$pattern" "camera=${own[0]%%=*}"
        ! queue ! join.)
    head=$((head + 1))
  done
else
  join=(triangulate name=join "rig=$rig" "pattern=$pattern")
  for film in "$@"; do
    add_film "$film"
    films+=(! siftmatch "pattern=$pattern" "camera=$camera" ! queue ! join.)
  done
fi

mkdir -p "$out"
heading "Films to a mesh"
launch "${join[@]}" ! meshfill ! meshsink "location=$out/cloth.take" "${films[@]}"
if ! any_located "$out/cloth.take"; then
  echo "nothing of the print was located: see the warnings above, and that $pattern names" \
      "the picture of the print that was filmed and $rig the cameras as they stood" >&2
  exit 1
fi
# Which way was up stays in the take.
cp "$rig" "$out/cloth.take/rig.json"
launch meshsrc "location=$out/cloth.take" ! meshsink "location=$out/cloth.obj"

heading "A check over the first film"
launch videotestsrc num-buffers=1 pattern=checkers-8 ! video/x-raw,width=256,height=256 \
    ! pngenc ! filesink "location=$out/check.png"
launch filesrc "location=${first#*=}" ! decodebin "${upright[@]}" ! videoconvert \
        ! clothoverlay name=over \
        "rig=$rig" "camera=${first%%=*}" mesh-style=shaded "texture=$out/check.png" \
    ! videoconvert ! jpegenc ! avimux ! filesink "location=$out/check.avi" \
    meshsrc "location=$out/cloth.take" ! over.mesh

heading "Done"
cat <<END
  take (NumPy, meshsrc)    $out/cloth.take
  Blender and most others  $out/cloth.obj with cloth.pc2
  to look at               $out/check.avi: the check moves with the cloth
END
