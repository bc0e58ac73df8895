# Builds under sanitizers and runs what is worth it there: to be sourced by tests/run.sh, in
# the folder of the source.
# SPDX-License-Identifier: LGPL-2.1-or-later

# Minutes each under a sanitizer. What they run is run by shorter ones as well.
CLOTH_SLOW="board calibrate dot filming gapdiagnose gapexperiment link print quad roll
    simcontact simdynamics take"
# Whole chains, films and takes through files, and programs.
CLOTH_CHAINS="film-mesh film-observations film-paper film-take"
CLOTH_PROGRAMS="gaptool patterntool states"
# What has threads: the pool and who uses it, elements that join streams, the observer.
CLOTH_THREADED_CORE="pool triangulator nearest reconstruct fill siminvariance simcontact gaplinear search"
CLOTH_THREADED_ELEMENTS="clothsync clothsynclive triangulate triangulateinput triangulatedots triangulatematches
    triangulatestream clothoverlay clothoverlaymesh clothoverlayinput clothgap clothsim meshfill"

# cloth_select_plugins FOLDER: some of GStreamer's plugins bring libraries that the sanitizers
# trip over, so only those that the tests use are seen. A link each: GStreamer takes whole
# folders.
cloth_select_plugins ()
{
  local stock name

  stock=$(pkg-config --variable=pluginsdir gstreamer-1.0)
  rm -rf "$1/sanitize-plugins" "$1/sanitize-registry.bin"
  mkdir -p "$1/sanitize-plugins"
  for name in alpha app audiofx audiotestsrc autodetect compositor coreelements coretracers \
      debugutilsbad deinterlace gdp geometrictransform imagefreeze isomp4 jpeg jpegformat \
      libav matroska multifile openh264 openjpeg playback png rawparse rtp rtpmanager \
      staticelements theora timecode typefindfunctions udp videobox videoconvertscale videocrop \
      videofilter videoparsersbad videorate videotestsrc vpx; do
    [ ! -e "$stock/libgst$name.so" ] || ln -s "$stock/libgst$name.so" "$1/sanitize-plugins/"
  done
  export GST_PLUGIN_SYSTEM_PATH_1_0=$1/sanitize-plugins
  export GST_REGISTRY_1_0=$1/sanitize-registry.bin
  export GST_REGISTRY_FORK=no
}

# cloth_build_sanitized FOLDER COMPILER SANITIZERS [TARGET...]
cloth_build_sanitized ()
{
  # -O1 finds the same in half the time. Sanitizers confuse gcc's warnings of uninitialised
  # variables.
  [ -f "$1/build.ninja" ] ||
    CC=$2 CXX=${2/gcc/g}++ meson setup "$1" "-Db_sanitize=$3" -Db_lundef=false \
        -Doptimization=1 -Dintrospection=disabled -Dwerror=false ||
    return 1
  ninja -C "$1" "${@:4}"
}

# cloth_names FOLDER SUITE: its tests but the slow ones, one a line.
cloth_names ()
{
  meson introspect --tests "$1" | /usr/bin/python3 -c '
import json, sys
slow = sys.argv[2].split()
for test in json.load(sys.stdin):
    if any(suite.split(":")[-1] == sys.argv[1] for suite in test["suite"]) \
            and test["name"] not in slow:
        print(test["name"])
' "$2" "$CLOTH_SLOW"
}

# cloth_test_share FOLDER SUITE NAME...: into the log share-SUITE.json.
cloth_test_share ()
{
  local folder=$1 suite=$2

  shift 2
  rm -f "$folder/meson-logs/share-$suite.json"
  # Without a name meson would run all.
  [ $# -gt 0 ] || return 1
  meson test -C "$folder" --no-rebuild --print-errorlogs --logbase "share-$suite" \
      --suite "$suite" -t 6 "$@"
}

# cloth_test_addresses FOLDER: in a shell of its own, for what it exports.
cloth_test_addresses ()
(
  local folder status=0 asan

  folder=$(cd "$1" && pwd)
  cloth_select_plugins "$folder"
  export G_SLICE=always-malloc
  export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1:suppressions=$PWD/tests/ubsan.supp
  export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
  asan=abort_on_error=1:allocator_may_return_null=1:fast_unwind_on_malloc=0
  # shellcheck disable=SC2046
  ASAN_OPTIONS=$asan:detect_leaks=1 \
    cloth_test_share "$folder" core $(cloth_names "$folder" core) || status=1
  # Leaks of elements are for GStreamer's own tracer (test leaks-states, leaks-chain): what
  # its plugins keep until the end of the program would drown them here.
  export ASAN_OPTIONS=$asan:detect_leaks=0
  # shellcheck disable=SC2046
  cloth_test_share "$folder" elements $(cloth_names "$folder" elements) || status=1
  # shellcheck disable=SC2086
  cloth_test_share "$folder" pipelines $CLOTH_CHAINS || status=1
  # shellcheck disable=SC2086
  cloth_test_share "$folder" generic $CLOTH_PROGRAMS || status=1
  echo "Left out of $1: $CLOTH_SLOW, and the pipelines and programs but $CLOTH_CHAINS $CLOTH_PROGRAMS"
  exit $status
)

# cloth_test_races FOLDER: in a shell of its own, for what it preloads.
cloth_test_races ()
(
  local folder status=0

  folder=$(cd "$1" && pwd)
  cloth_select_plugins "$folder"
  # GLib's locks aren't pthread's, so the sanitizer has to be told of them.
  gcc -shared -fPIC -O1 -g -Wall -Werror -o "$folder/tsan-locks.so" tests/tsan-locks.c \
      $(pkg-config --cflags --libs glib-2.0 gobject-2.0) -ldl || return 1
  # What one thread frees and another one gets must not look like one place.
  export G_SLICE=always-malloc
  export LD_PRELOAD=$folder/tsan-locks.so
  # Elements lock their pads one way going up and another going down the stream, on purpose.
  export TSAN_OPTIONS=halt_on_error=1:ignore_noninstrumented_modules=1:detect_deadlocks=0
  # shellcheck disable=SC2086
  cloth_test_share "$folder" core $CLOTH_THREADED_CORE || status=1
  # shellcheck disable=SC2086
  cloth_test_share "$folder" elements $CLOTH_THREADED_ELEMENTS || status=1
  exit $status
)
