#!/bin/bash
# From a fresh Debian 12 to films, meshes and a table of errors, with the data that is
# shipped: installs packages, builds, calibrates a real stereo pair from pictures of a
# board, tracks a cloth filmed by two cameras and puts it into space, then says what a
# simulation lacks of the cloth of another simulator.
#
#   pipelines/quickstart.sh [OUTPUT-FOLDER]      (default: cloth-quickstart)
#
# CLOTH_BUILD names a finished build to use instead of making one in ./build.
# SPDX-License-Identifier: LGPL-2.1-or-later
set -euo pipefail
here=$PWD
root=$(cd "$(dirname "$0")/.." && pwd)
out=${1:-cloth-quickstart}
export LC_ALL=C.UTF-8

. "$root/pipelines/films.sh"

if [ -z "${CLOTH_BUILD:-}" ]; then
  heading "Packages"
  . "$root/tests/packages.sh"
  cloth_install_packages "$root"
  heading "Build"
  cd "$root"
  cloth_set_up_build --buildtype=release
  ninja -C build programs
  cd "$here"
fi
. "$root/pipelines/environment.sh"

started=$SECONDS
mkdir -p "$out"
out=$(cd "$out" && pwd)
boards=$root/tests/data/opencv_boards
pair=$root/tests/data/checker_pair

heading "Real pictures of a board: calibration of the stereo pair"
gst-cloth-calibrate-1.0 --pattern "$boards/pattern.json" \
    --output "$out/boards-rig.json" \
    "left=$boards/left*.jpg" "right=$boards/right*.jpg" | tee "$out/boards-report.txt"

heading "Real pictures of a board: the squares found"
mkdir -p "$out/boards"
for picture in "$boards"/left??.jpg "$boards"/right??.jpg; do
  launch filesrc location="$picture" \
      ! jpegdec ! saddledetect ! quadtrack pattern="$boards/pattern.json" \
      ! videoconvert ! video/x-raw,format=RGB ! clothoverlay ! pngenc \
      ! filesink location="$out/boards/$(basename "$picture" .jpg).png"
done
echo "$(find "$out/boards" -name '*.png' -size +0 | wc -l) pictures"

heading "A cloth filmed by two cameras: squares, mesh and overlay"
camera ()
{
  echo "filesrc location=$pair/$1.mp4 ! qtdemux ! h264parse ! avdec_h264
      ! saddledetect ! quadtrack pattern=$pair/pattern.json camera=$1 ! tee name=$1
      $1. ! queue ! join.
      $1. ! queue ! clothoverlay ! videoconvert
      ! vp8enc deadline=1 target-bitrate=6000000 ! webmmux
      ! filesink location=$out/$1-overlay.webm"
}
# shellcheck disable=SC2046
launch triangulate name=join rig="$pair/rig.json" pattern="$pair/pattern.json" \
    ! tee name=mesh \
    mesh. ! queue ! meshsink location="$out/cloth.obj" \
    mesh. ! queue ! meshsink location="$out/cloth-take" format=take \
    $(camera cam0) $(camera cam1)

heading "Errors against the true cloth"
status=0
/usr/bin/python3 "$root/pipelines/compare-truth.py" "$out/cloth-take" \
    --truth "$pair/vertices.npy" --grid 33x35 --pattern "$pair/pattern.json" \
    --max-rms-mm 0.9 | tee "$out/errors.txt" || status=$?

heading "What a simulation lacks: another simulator's cloth, gravity tilted unbeknown to ours"
# Every second row and column: half a minute in place of three.
/usr/bin/python3 - "$root/tests/data/arcsim" "$out/arcsim" <<'END'
import json, os, shutil, sys
import numpy

for name in ('tilted', 'base'):
    whole, thin = (os.path.join(folder, name) for folder in sys.argv[1:])
    shutil.copytree(whole, thin, dirs_exist_ok=True)
    with open(thin + '/take.json', encoding='utf-8') as file:
        take = json.load(file)
    columns, rows = take['grid']['columns'], take['grid']['rows']
    places = numpy.load(thin + '/positions.npy').reshape(-1, rows, columns, 3)[:, ::2, ::2]
    numpy.save(thin + '/positions.npy', places.reshape(len(places), -1, 3))
    take['grid']['rows'], take['grid']['columns'] = places.shape[1:3]
    for held in take['held']:
        row, column = divmod(held['vertex'], columns)
        held['vertex'] = row // 2 * places.shape[2] + column // 2
    with open(thin + '/take.json', 'w', encoding='utf-8') as file:
        json.dump(take, file)
END
gst-cloth-gap-1.0 diagnose "$out/arcsim/tilted" --baseline "$out/arcsim/base" \
    --model "$root/tests/data/arcsim/model.json" \
    --effects gravity_tilt,wind,air_drag --output "$out/gap" | tee "$out/gap.txt"

heading "Done in $((SECONDS - started)) s"
cat <<END
  calibrated rig           $out/boards-rig.json
  squares found            $out/boards/*.png
  films with the overlay   $out/cam0-overlay.webm, $out/cam1-overlay.webm
  mesh (Blender: OBJ+PC2)  $out/cloth.obj, $out/cloth.pc2
  mesh (NumPy)             $out/cloth-take
  the diagnosis' report    $out/gap/report.html

To use the elements in this shell:  . $root/pipelines/environment.sh
END
exit $status
