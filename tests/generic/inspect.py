#!/usr/bin/python3
"""gst-inspect-1.0 over the plugin and each of its elements: quiet, and all fields filled.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import re
import subprocess
import sys


def inspect(*arguments):
    done = subprocess.run(['gst-inspect-1.0', *arguments], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True)
    if done.returncode or done.stderr.strip():
        sys.exit('gst-inspect-1.0 %s: exit code %d\n%s'
                 % (' '.join(arguments), done.returncode, done.stderr))
    return done.stdout


plugin = inspect('cloth')
for field, wanted in (('Name', 'cloth'), ('License', 'LGPL'), ('Source module', 'gst-cloth')):
    if not re.search(r'^\s*%s\s+%s$' % (field, wanted), plugin, re.M):
        sys.exit('%s is not %s:\n%s' % (field, wanted, plugin))
elements = re.findall(r'^  (\w+): ', plugin, re.M)
if not elements:
    sys.exit('no elements:\n' + plugin)
for element in elements:
    text = inspect(element)
    for field, wanted in (('Rank', r'\S'), ('Long-name', r'\S'), ('Klass', r'\S'),
                          ('Description', r'\S'), ('Author', 'The gst-cloth developers$')):
        if not re.search(r'^\s*%s\s+%s' % (field, wanted), text, re.M):
            sys.exit('%s: no %s' % (element, field))
    if 'Pad Templates:' not in text:
        sys.exit('%s: no pad templates' % element)
print('%d elements inspected: %s' % (len(elements), ', '.join(elements)))
