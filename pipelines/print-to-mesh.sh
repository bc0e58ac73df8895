#!/bin/bash
# From films of a cloth with any print to its animated mesh: matches every film with the
# picture of the flat cloth, puts what two cameras see into space, fills the holes, and lays a
# check over the first film, which shows wherever the mesh slips.
#
#   pipelines/print-to-mesh.sh RIG PATTERN OUTPUT CAMERA=FILM CAMERA=FILM...
#
# RIG is the rig.json, PATTERN the pattern.json of kind "picture", OUTPUT the folder that is
# filled, each CAMERA a name in the rig. Films of one rig start together.
# SPDX-License-Identifier: LGPL-2.1-or-later
set -euo pipefail
if [ $# -lt 5 ]; then
  sed -n 's/^#   //p' "$0" >&2
  exit 2
fi
. "$(dirname "$0")/environment.sh"
. "$(dirname "$0")/films.sh" # pipelines/films.sh
rig=$1 pattern=$2 out=$3
shift 3

# The first film tells how far all are.
films=()
progress=(! progressreport name=filmed update-freq=2)
for film in "$@"; do
  camera=${film%%=*} file=${film#*=}
  if [ "$camera" = "$film" ] || [ ! -f "$file" ]; then
    echo "$film: no film; write CAMERA=FILE" >&2
    exit 2
  fi
  films+=(filesrc "location=$file" ! decodebin "${progress[@]}" ! videoconvert
      ! video/x-raw,format=GRAY8 ! siftmatch "pattern=$pattern" "camera=$camera"
      ! queue ! join.)
  progress=()
done

mkdir -p "$out"
heading "Films to a mesh"
launch triangulate name=join "rig=$rig" "pattern=$pattern" ! meshfill \
    ! meshsink "location=$out/cloth.take" "${films[@]}"
if ! any_located "$out/cloth.take"; then
  echo "nothing of the print was located: see the warnings above, and that $pattern names" \
      "the picture of the print that was filmed and $rig the cameras as they stood" >&2
  exit 1
fi
launch meshsrc "location=$out/cloth.take" ! meshsink "location=$out/cloth.obj"

heading "A check over the first film"
launch videotestsrc num-buffers=1 pattern=checkers-8 ! video/x-raw,width=256,height=256 \
    ! pngenc ! filesink "location=$out/check.png"
launch filesrc "location=${1#*=}" ! decodebin ! videoconvert ! clothoverlay name=over \
        "rig=$rig" "camera=${1%%=*}" mesh-style=shaded "texture=$out/check.png" \
    ! videoconvert ! jpegenc ! avimux ! filesink "location=$out/check.avi" \
    meshsrc "location=$out/cloth.take" ! over.mesh

heading "Done"
cat <<END
  take (NumPy, meshsrc)    $out/cloth.take
  Blender and most others  $out/cloth.obj with cloth.pc2
  to look at               $out/check.avi: the check moves with the cloth
END
