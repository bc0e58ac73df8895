#!/usr/bin/env python3
"""Counts what meson's logs say. The last line is "N passed, N failed".

  tests/count.py EXIT-CODE LOG...     (the worst of the exit codes of meson test)

A skipped test has tested nothing: it fails, and so does a log that is not there.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import sys

GOOD = {'OK', 'EXPECTEDFAIL'}
passed = failed = 0
for log in sys.argv[2:]:
    before = passed + failed
    try:
        with open(log, encoding='utf-8') as file:
            for line in file:
                test = json.loads(line)
                if test['result'] in GOOD:
                    passed += 1
                else:
                    failed += 1
                    print('%s: %s' % (test['result'], test['name']))
    except OSError as error:
        print(error)
    if passed + failed == before:
        failed += 1
if int(sys.argv[1]) and not failed:
    failed += 1
print('%d passed, %d failed' % (passed, failed))
sys.exit(1 if failed else 0)
