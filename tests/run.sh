#!/bin/bash
# Installs what is missing, builds and tests; the last line is "N passed, N failed".
#
#   tests/run.sh                every test but the long ones (suites soak and fuzz), those
#                               that need a network (suite registry) and those of other
#                               programs (suites blender, bullet and cluster), in ./build
#   tests/run.sh --sanitize     a share of them under the address and undefined-behaviour
#                               sanitizers, in ./build-asan-gcc and ./build-asan-clang
#   tests/run.sh --tsan         what has threads under the thread sanitizer, in ./build-tsan
#
# SPDX-License-Identifier: LGPL-2.1-or-later
set -u
cd "$(dirname "$0")/.." || exit 1
root=$PWD
export LC_ALL=C.UTF-8

. tests/packages.sh
. tests/sanitize.sh

fail ()
{
  echo "$1" >&2
  echo "0 passed, 1 failed"
  exit 1
}

test_everything ()
{
  # A name of its own: tests of the documents run meson as well.
  local log=build/meson-logs/run.json

  cloth_set_up_build || fail "meson could not set up the build"
  ninja -C build || fail "the build is broken"
  rm -f "$log"
  meson test -C build --no-rebuild --logbase run --print-errorlogs \
      --no-suite soak --no-suite fuzz --no-suite registry \
      --no-suite blender --no-suite bullet --no-suite cluster
  /usr/bin/python3 tests/count.py $? "$log"
}

test_sanitized ()
{
  local logs=() worst=0 compiler

  for compiler in gcc clang; do
    cloth_build_sanitized "build-asan-$compiler" "$compiler" address,undefined ||
      fail "the build by $compiler is broken"
    cloth_test_addresses "build-asan-$compiler" || worst=1
    logs+=("build-asan-$compiler"/meson-logs/share-*.json)
  done
  /usr/bin/python3 tests/count.py $worst "${logs[@]}"
}

test_threads ()
{
  local worst=0

  # shellcheck disable=SC2086
  cloth_build_sanitized build-tsan gcc thread elements/libgstcloth.so \
      $(printf 'tests/core/core-%s ' $CLOTH_THREADED_CORE) \
      $(printf 'tests/elements/elements-%s ' $CLOTH_THREADED_ELEMENTS) ||
    fail "the build is broken"
  cloth_test_races build-tsan || worst=1
  /usr/bin/python3 tests/count.py $worst build-tsan/meson-logs/share-*.json
}

case "${1:-}" in
  "") more=() ;;
  --sanitize) more=(clang libclang-rt-dev) ;;
  --tsan) more=() ;;
  *) fail "tests/run.sh takes --sanitize, --tsan or nothing" ;;
esac
cloth_install_packages "$root" "${more[@]}" || fail "the packages could not be installed"
case "${1:-}" in
  --sanitize) test_sanitized ;;
  --tsan) test_threads ;;
  *) test_everything ;;
esac
