#!/usr/bin/python3
"""Keeps docs/effects.md true: its list is made from the table of effects.

  effectsdoc.py --check TOOL FILE.md     exit code 1 when the list differs
  effectsdoc.py --write TOOL FILE.md     puts the list in; the prose before it stays

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import difflib
import os
import subprocess
import sys

MARK = '<!-- made from the table of effects -->\n'
mode, tool, path = sys.argv[1:]
made = subprocess.run([tool, 'effects', '--format', 'markdown'], check=True, timeout=60,
                      stdout=subprocess.PIPE, env=dict(os.environ, LC_ALL='C.UTF-8')).stdout
with open(path, encoding='utf-8') as file:
    text = file.read()
if text.count(MARK) != 1:
    sys.exit('%s: needs the line %s' % (path, MARK))
new = text.split(MARK)[0] + MARK + made.decode('utf-8').rstrip() + '\n'
if mode == '--write':
    with open(path, 'w', encoding='utf-8') as file:
        file.write(new)
    sys.exit(0)
difference = ''.join(difflib.unified_diff(text.splitlines(True), new.splitlines(True),
                                          path, 'the table'))
if difference:
    print(difference)
    print('Run `meson compile -C build docs-effects`.')
    sys.exit(1)
print('%d effects, list true' % new.count('\n### '))
