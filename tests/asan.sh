#!/bin/bash
# The core and element tests under the address and undefined-behaviour sanitizers.
#
#   tests/asan.sh [BUILD-FOLDER]      (default: build-asan)
#
# SPDX-License-Identifier: LGPL-2.1-or-later
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build-asan}
export LC_ALL=C.UTF-8

# Sanitizers confuse the compiler's warnings of uninitialised variables.
[ -f "$build/build.ninja" ] ||
  meson setup "$build" -Db_sanitize=address,undefined -Db_lundef=false \
      -Dintrospection=disabled -Dbenchmarks=disabled -Dwerror=false
ninja -C "$build"
build=$(cd "$build" && pwd)

# Some of GStreamer's plugins bring libraries that the sanitizers trip over, so only
# those that the tests use are seen. A link each: GStreamer takes whole folders.
stock=$(pkg-config --variable=pluginsdir gstreamer-1.0)
plugins=$build/asan-plugins
rm -rf "$plugins" "$build/asan-registry.bin"
mkdir -p "$plugins"
for name in alpha app audiofx audiotestsrc autodetect compositor coreelements coretracers \
    debugutilsbad deinterlace gdp geometrictransform imagefreeze isomp4 jpeg jpegformat \
    libav matroska multifile openh264 openjpeg playback png rawparse rtp rtpmanager staticelements \
    theora timecode typefindfunctions udp videobox videoconvertscale videocrop \
    videofilter videoparsersbad videorate videotestsrc vpx; do
  [ -e "$stock/libgst$name.so" ] && ln -s "$stock/libgst$name.so" "$plugins/"
done

export GST_PLUGIN_SYSTEM_PATH_1_0=$plugins
export GST_REGISTRY_1_0=$build/asan-registry.bin
export GST_REGISTRY_FORK=no
export G_SLICE=always-malloc
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1:suppressions=$PWD/tests/ubsan.supp
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
asan=abort_on_error=1:allocator_may_return_null=1:fast_unwind_on_malloc=0

# Leaks of elements are for GStreamer's own tracer (test leaks-states, leaks-chain): what
# its plugins keep until the end of the program would drown them here.
ASAN_OPTIONS=$asan:detect_leaks=1 \
  meson test -C "$build" --no-rebuild --print-errorlogs --suite core -t 4
ASAN_OPTIONS=$asan:detect_leaks=0 \
  meson test -C "$build" --no-rebuild --print-errorlogs --suite elements -t 4
