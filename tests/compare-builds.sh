#!/bin/bash
# Shows that two builds make the same bytes of the shipped inputs: observations, meshes in
# every format and as it is read back, pictures, prints, rigs, simulated takes, diagnoses
# and what docs/gap.md does with films.
#
#   tests/compare-builds.sh OLD-BUILD NEW-BUILD [OUTPUT-FOLDER]
#
# Both are build folders of meson. Of gap.json and of the report only the value of `seconds`
# may differ, and of the report what is not the input's: script and style.
# The last line is "N files compared, N differ"; exit code 0 when none does.
# SPDX-License-Identifier: LGPL-2.1-or-later
set -euo pipefail
if [ $# -lt 2 ]; then
  sed -n 's/^#   //p' "$0" >&2
  exit 2
fi
old=$(cd "$1" && pwd) new=$(cd "$2" && pwd)
cd "$(dirname "$0")/.."
data=$PWD/tests/data
out=${3:-$(mktemp -d)}
mkdir -p "$out"
out=$(cd "$out" && pwd)
export LC_ALL=C.UTF-8

launch () { gst-launch-1.0 -q "$@"; }

# Everything that one build makes, into the folder $2.
make_all () (
  build=$1
  mkdir -p "$2"
  cd "$2"
  export GST_PLUGIN_PATH_1_0=$build/elements GST_REGISTRY_1_0=$2.registry
  pair=$data/checker_pair dots=$data/dots_ring8 arcsim=$data/arcsim

  "$build/tools/gst-cloth-pattern-1.0" coded-checker --columns 12 --rows 9 --square 30mm \
      --output checker.svg >/dev/null
  mkdir m-array
  "$build/tools/gst-cloth-pattern-1.0" m-array --columns 76 --rows 80 --output m-array/dots.svg \
      >/dev/null
  "$build/tools/gst-cloth-calibrate-1.0" --pattern "$data/opencv_boards/pattern.json" \
      --output rig.json "left=$data/opencv_boards/left*.jpg" \
      "right=$data/opencv_boards/right*.jpg" >calibrate.txt
  "$build/tools/gst-cloth-gap-1.0" effects >effects.txt

  for camera in cam0 cam1; do
    launch filesrc location="$pair/$camera.mp4" ! qtdemux ! h264parse ! avdec_h264 \
        ! saddledetect ! quadtrack pattern="$pair/pattern.json" camera="$camera" \
        ! tee name=t \
        t. ! queue ! clothmetapay ! filesink location="$camera.obs" \
        t. ! queue ! clothoverlay ! videoconvert ! video/x-raw,format=RGB ! pngenc \
        ! multifilesink location="$camera-%03d.png"
  done
  films=()
  for camera in cam0 cam1; do
    films+=(filesrc "location=$pair/$camera.mp4" ! qtdemux ! h264parse ! avdec_h264
        ! saddledetect ! quadtrack "pattern=$pair/pattern.json" "camera=$camera"
        ! queue ! join.)
  done
  launch triangulate name=join rig="$pair/rig.json" pattern="$pair/pattern.json" \
      ! tee name=t t. ! queue ! meshsink location=pair.take \
      t. ! queue ! meshfill ! meshsink location=filled.take "${films[@]}"
  films=()
  for n in 0 1 2 3 4 5 6 7; do
    films+=(filesrc "location=$dots/cam$n.mp4" ! decodebin ! videoconvert
        ! video/x-raw,format=I420 ! dotlabel "pattern=$dots/pattern.json" "camera=cam$n"
        ! tee "name=t$n" "t$n." ! queue ! join.
        "t$n." ! queue ! clothmetapay ! filesink "location=dots-cam$n.obs")
  done
  launch triangulate name=join rig="$dots/rig8.json" pattern="$dots/pattern.json" \
      ! meshfill ! meshsink location=ring.take "${films[@]}"
  for ending in obj ply glb usda pvd c3d csv; do
    launch meshsrc location=filled.take ! meshsink location="pair-$ending.$ending"
  done
  launch meshsrc location=pair-obj.obj ! meshsink location=pair-obj.take
  launch meshsrc location=pair-ply.ply ! meshsink location=pair-ply.take
  launch filesrc location="$dots/cam0.mp4" ! decodebin ! videoconvert \
      ! dotlabel pattern="$dots/pattern.json" camera=cam0 ! clothoverlay ! videoconvert \
      ! video/x-raw,format=RGB ! pngenc snapshot=true ! filesink location=labels.png
  launch filesrc location="$dots/cam0.mp4" ! decodebin ! videoconvert \
      ! clothoverlay name=over rig="$dots/rig8.json" camera=cam0 mesh-style=shaded \
          texture="$data/opencv_boards/left01.jpg" \
      ! videoconvert ! video/x-raw,format=RGB ! pngenc snapshot=true \
      ! filesink location=shaded.png meshsrc location=ring.take ! over.mesh
  for board in left01 right08; do
    launch filesrc location="$data/opencv_boards/$board.jpg" ! jpegdec ! saddledetect \
        ! quadtrack pattern="$data/opencv_boards/pattern.json" ! videoconvert \
        ! video/x-raw,format=RGB ! clothoverlay ! pngenc ! filesink location="$board.png"
  done
  "$build/tools/gst-cloth-pattern-1.0" garment --pattern m-array/pattern.json "$data/../../pipelines/skirt.svg" \
      --output skirt >/dev/null
  launch meshsrc location=filled.take \
      ! clothcamera rig="$pair/rig.json" camera=cam1 pattern="$pair/pattern.json" \
          effects="noise,sigma=3; motion_blur,exposure=0.01" seed=3 \
      ! videoconvert ! video/x-raw,format=RGB ! pngenc \
      ! multifilesink location="filmed-%03d.png"
  "$build/tools/gst-cloth-gap-1.0" simulate "$arcsim/model.json" --scene "$arcsim/tilted" \
      --output simulated >/dev/null
  "$build/tools/gst-cloth-gap-1.0" diagnose "$arcsim/tilted" --baseline "$arcsim/base" \
      --model "$arcsim/model.json" --effects gravity_tilt,wind,air_drag --output gap-tilted \
      >gap-tilted.txt
  for take in take_drag take_drop; do
    "$build/tools/gst-cloth-gap-1.0" diagnose "$data/$take" \
        --model "$data/../../pipelines/model-knit.json" --output "gap-$take" >"gap-$take.txt"
  done
  "$build/tools/gst-cloth-gap-1.0" diagnose "$arcsim/tilted" --hold-out "$arcsim/base" \
      --model "$arcsim/model.json" --effects gravity_tilt,wind --output gap-hold-out \
      >gap-hold-out.txt
  # Cameras that are off and clothgap: the lines of the document.
  ln -s "$data/.." tests
  ln -s "$data/../../pipelines" pipelines
  awk '/^```sh$/ { on = 1; next } /^```$/ { on = 0 } on' "$data/../../docs/gap.md" >gap.sh
  PATH=$build/tools:$PATH bash -e gap.sh >gap.sh.txt 2>&1 || { cat gap.sh.txt >&2; exit 1; }
  rm tests pipelines gap.sh.txt
  sed -i '/^ *"seconds": /d' gap*/gap.json
  for page in gap*/report.html; do
    sed -n '/<script type="application\/json"/,/<\/script>/p' "$page" | sed '/^ *"seconds": /d' \
        >"${page%.html}.blocks"
    rm "$page"
  done
)

make_all "$old" "$out/old"
make_all "$new" "$out/new"
files=$(cd "$out/new" && find . -type f | wc -l)
empty=$(cd "$out/new" && find . -type f -empty)
if [ -n "$empty" ]; then
  echo "empty: $empty" >&2
  exit 1
fi
status=0
diff -rq "$out/old" "$out/new" >"$out/differ.txt" || status=$?
cat "$out/differ.txt" >&2
echo "$files files compared, $(wc -l <"$out/differ.txt") differ"
exit "$status"
