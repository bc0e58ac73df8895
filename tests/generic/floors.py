#!/usr/bin/python3
"""Checks the floors of the house: who may include whom, and where C++ lives.

  floors.py ROOT          checks the sources under ROOT
  floors.py --self-test   shows that each rule catches a file that breaks it

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import re
import sys
import tempfile

# Lowest first: a room may include itself and those before it.
ROOMS = ['gst/math', 'gst/file', 'gst/effect', 'gst/pattern', 'gst/rig', 'gst/mesh',
         'gst/take', 'gst/render', 'gst/vision', 'gst/sim', 'gst/fit', 'gst/gap']
# gst/cloth stands apart: it knows GStreamer and none of the algorithm rooms.
LIBRARY = 'gst/cloth'
UPPER = ['gst/cloth-io', 'elements', 'tools', 'tests']
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.M)
LICENCE = 'SPDX-License-Identifier: LGPL-2.1-or-later'
MAX_LINES = 800


def room_of(path):
    for room in ROOMS + [LIBRARY] + UPPER:
        if path.startswith(room + '/'):
            return room
    return None


def is_gstreamer(name):
    if room_of(name) in ROOMS:
        return False
    return name.startswith('gst/')


def check(root):
    faults = []
    seen = 0
    for top in ('gst', 'elements', 'tools', 'tests'):
        for folder, _, names in os.walk(os.path.join(root, top)):
            for name in sorted(names):
                path = os.path.relpath(os.path.join(folder, name), root)
                ending = os.path.splitext(name)[1]
                if ending in ('.cpp', '.cc', '.cxx', '.hpp') and \
                        not path.startswith('tests/'):
                    faults.append('%s: C++ is only in tests/reference' % path)
                if ending not in ('.c', '.h', '.cpp', '.cc', '.hpp'):
                    continue
                seen += 1
                with open(os.path.join(root, path), encoding='utf-8') as file:
                    text = file.read()
                faults += check_file(root, path, text)
    if not seen:
        faults.append('%s: no source found' % root)
    print('%d files checked' % seen)
    return faults


def check_file(root, path, text):
    faults = []
    room = room_of(path)
    if room is None:
        faults.append('%s: in no room of the house' % path)
    if LICENCE not in text[:2000]:
        faults.append('%s: no line with the licence near the top' % path)
    if re.search(r'\b(TODO|FIXME|XXX)\b', text):
        faults.append('%s: unfinished work is not left in the source' % path)
    # Tests are lists of cases: their length hides nothing.
    if room != 'tests' and text.count('\n') > MAX_LINES:
        faults.append('%s: %d lines, split it' % (path, text.count('\n')))
    for name in INCLUDE.findall(text):
        other = room_of(name)
        if room in ROOMS and is_gstreamer(name):
            faults.append('%s: an algorithm room includes %s' % (path, name))
        elif room in ROOMS and other in UPPER:
            faults.append('%s: includes %s, which is above it' % (path, name))
        elif room in ROOMS and other in ROOMS and ROOMS.index(other) > ROOMS.index(room):
            faults.append('%s: includes %s, which is above it' % (path, name))
        elif room == LIBRARY and (other in ROOMS or other in UPPER):
            faults.append('%s: the library includes %s' % (path, name))
        elif room == 'tools' and other == 'tests' or room == 'elements' and other in ('tools', 'tests'):
            faults.append('%s: includes %s, which is above it' % (path, name))
        if name.startswith('opencv') and not path.startswith('tests/'):
            faults.append('%s: OpenCV is only in the tests' % path)
        if other in ROOMS and not os.path.exists(os.path.join(root, name)):
            faults.append('%s: %s does not exist' % (path, name))
    return faults


def self_test():
    head = '/* ' + LICENCE + ' */\n'
    wrong = {
        'gst/math/a.c': head + '#include "gst/vision/b.h"\n',
        'gst/vision/a.c': head + '#include <gst/gst.h>\n',
        'gst/rig/a.c': head + '#include <gst/cloth/cloth.h>\n',
        'gst/pattern/a.c': head + '#include <opencv2/core.hpp>\n',
        'gst/cloth/a.c': head + '#include "gst/math/cpu.h"\n',
        'gst/mesh/a.c': head + '#include "elements/gstx.h"\n',
        'elements/a.c': head + '#include "tests/a.h"\n',
        'gst/vision/a.cpp': head,
        'gst/math/b.c': '/* no licence */\n',
        'gst/math/c.c': head + '\n' * (MAX_LINES + 1),
        'gst/other/a.c': head,
        'tools/a.c': head + '/* TO' + 'DO: think */\n',
    }
    status = 0
    for path, text in wrong.items():
        with tempfile.TemporaryDirectory() as root:
            for also in (path, 'gst/vision/b.h', 'gst/math/cpu.h'):
                full = os.path.join(root, also)
                os.makedirs(os.path.dirname(full), exist_ok=True)
                with open(full, 'w', encoding='utf-8') as file:
                    file.write(text if also == path else head)
            faults = check(root)
            print(faults)
            if len(faults) != 1 or not faults[0].startswith(path):
                print('not caught: ' + path)
                status = 1
    return status


if sys.argv[1] == '--self-test':
    sys.exit(self_test())
found = check(sys.argv[1])
for fault in found:
    print(fault)
sys.exit(1 if found else 0)
