#!/bin/bash
# Which lines and branches of each room the tests run.
#
#   tests/coverage.sh           builds into ./build-coverage, runs the suites core, elements and
#                               generic, prints a table; what stays uncovered is listed in
#                               build-coverage/uncovered.txt. Fails when a test does, or an
#                               aim is missed
#
# SPDX-License-Identifier: LGPL-2.1-or-later
set -u
cd "$(dirname "$0")/.." || exit 1
export LC_ALL=C.UTF-8
build=build-coverage

[ -f $build/build.ninja ] ||
  CC=gcc CXX=g++ meson setup $build -Db_coverage=true -Doptimization=1 \
      -Dwerror=false || exit 1
ninja -C $build || exit 1
# Counts of an earlier run are not those of this one.
find $build -name '*.gcda' -delete
meson test -C $build --no-rebuild --suite core --suite elements --suite generic
status=$?
/usr/bin/python3 tests/coverage.py $build && exit $status
