#!/bin/bash
# Installs what is missing, builds into ./build and runs every test but the
# long ones (suites soak and fuzz) and those that need a network (suite registry).
# The last line is "N passed, N failed".
# SPDX-License-Identifier: LGPL-2.1-or-later
set -u
cd "$(dirname "$0")/.." || exit 1
root=$PWD
export LC_ALL=C.UTF-8

. tests/packages.sh

fail ()
{
  echo "$1" >&2
  echo "0 passed, 1 failed"
  exit 1
}

cloth_install_packages "$root" || fail "the packages could not be installed"

cloth_set_up_build || fail "meson could not set up the build"
ninja -C build || fail "the build is broken"

# A name of its own: tests of the documents run meson as well.
log=build/meson-logs/run.json
rm -f "$log"
meson test -C build --no-rebuild --logbase run --print-errorlogs \
    --no-suite soak --no-suite fuzz --no-suite registry
status=$?

# Counted from meson's own log. A skipped test has tested nothing: it fails.
/usr/bin/python3 - "$log" "$status" <<'PY'
import json, sys

good = {'OK', 'EXPECTEDFAIL'}
passed = failed = 0
try:
    for line in open(sys.argv[1], encoding='utf-8'):
        test = json.loads(line)
        if test['result'] in good:
            passed += 1
        else:
            failed += 1
            print('%s: %s' % (test['result'], test['name']))
except OSError as error:
    print(error)
if passed + failed == 0 or (int(sys.argv[2]) and not failed):
    failed += 1
print('%d passed, %d failed' % (passed, failed))
sys.exit(1 if failed else 0)
PY
