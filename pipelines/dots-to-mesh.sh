#!/bin/bash
# From films of a cloth with coloured dots to its animated mesh, in the formats of other
# programs: finds and names the dots of every film, puts them into space, fills the holes.
#
#   pipelines/dots-to-mesh.sh RIG PATTERN OUTPUT CAMERA=FILM CAMERA=FILM...
#
# RIG is the rig.json, PATTERN the pattern.json, OUTPUT the folder that is filled, each
# CAMERA a name in the rig. Films of one rig start together.
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
films=() n=0
progress=(! progressreport name=filmed update-freq=2)
for film in "$@"; do
  camera=${film%%=*} file=${film#*=}
  if [ "$camera" = "$film" ] || [ ! -f "$file" ]; then
    echo "$film: no film; write CAMERA=FILE" >&2
    exit 2
  fi
  films+=(filesrc "location=$file" ! decodebin "${progress[@]}" "${upright[@]}"
      ! videoconvert ! video/x-raw,format=I420 ! dotlabel "pattern=$pattern" "camera=$camera"
      ! tee "name=saw$n" "saw$n." ! queue ! join. "saw$n." ! queue ! clothmetapay
      ! filesink "location=$out/cloth.take/observations/$camera.obs")
  progress=() n=$((n + 1))
done

# What the cameras saw stays in the take.
mkdir -p "$out/cloth.take/observations"
rm -f "$out/cloth.take/observations/"*.obs
cp "$rig" "$out/cloth.take/rig.json"
heading "Films to a mesh"
launch triangulate name=join "rig=$rig" "pattern=$pattern" ! meshfill \
    ! meshsink "location=$out/cloth.take" "${films[@]}"
if ! any_located "$out/cloth.take"; then
  echo "no dot was located: see the warnings above, and that $pattern is the print" \
      "that was filmed and $rig the cameras as they stood" >&2
  exit 1
fi

heading "The mesh in other formats"
written=()
for ending in obj ply usda pvd c3d csv; do
  written+=(t. ! queue ! meshsink "location=$out/cloth.$ending")
done
launch meshsrc "location=$out/cloth.take" ! progressreport name=written \
    update-freq=2 ! tee name=t "${written[@]}"
# of short clips only
launch meshsrc "location=$out/cloth.take" ! meshsink "location=$out/cloth.glb" ||
    echo "cloth.glb was not written, the rest was"

heading "What was found"
"$(dirname "$0")/dots-summary.py" "$out/cloth.take"

heading "Files"
cat <<END
  take (NumPy, meshsrc)    $out/cloth.take
  Blender and most others  $out/cloth.obj with cloth.pc2; $out/cloth_00000.ply and so on
  players on the web       $out/cloth.glb
  USD                      $out/cloth.usda
  ParaView                 $out/cloth.pvd
  motion capture           $out/cloth.c3d
  spreadsheets             $out/cloth.csv
END
