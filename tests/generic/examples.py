#!/usr/bin/python3
"""Builds examples/ as somebody else would, with Meson and with CMake, and runs them.

  examples.py MESON BUILD ROOT

What they print is compared with each other and with what NumPy reads of the take.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import shlex
import subprocess
import sys
import tempfile

import numpy

MESON, BUILD, ROOT = sys.argv[1:]
EXAMPLES = os.path.join(ROOT, 'examples')
FILM = os.path.join(ROOT, 'tests/data/checker_pair/cam0.mp4')
PATTERN = os.path.join(ROOT, 'tests/data/checker_pair/pattern.json')
TAKE = os.path.join(ROOT, 'tests/data/take_drop')
env = dict(os.environ, PKG_CONFIG_PATH=os.path.join(BUILD, 'meson-uninstalled'),
           CFLAGS='-Wall -Wextra -Werror -Wno-unused-parameter')
faults = []


def run(*command, good=True):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=120, env=env)
    if (done.returncode == 0) != good:
        faults.append('%s: exit code %d\n%s%s' % (' '.join(command), done.returncode, done.stdout,
                                                  done.stderr))
    return done


def expect(true, what):
    if not true:
        faults.append(what)


def python(*arguments, good=True):
    return run('/usr/bin/python3', os.path.join(EXAMPLES, 'metas.py'), *arguments, good=good)


with tempfile.TemporaryDirectory(prefix='cloth-examples-') as scratch:
    by_meson, by_cmake = (os.path.join(scratch, name) for name in ('meson', 'cmake'))
    run(*shlex.split(MESON), 'setup', by_meson, EXAMPLES)
    run(*shlex.split(MESON), 'compile', '-C', by_meson)
    run('cmake', '-S', EXAMPLES, '-B', by_cmake)
    run('cmake', '--build', by_cmake)
    if faults:
        sys.exit('\n'.join(faults))
    said = [run(os.path.join(folder, 'preview'), FILM, PATTERN).stdout
            for folder in (by_meson, by_cmake)]
    expect(said[0] == said[1], 'the two programs differ')
    for arguments, word in (((), 'usage'), (('none.mp4', PATTERN), 'none.mp4'),
                            ((FILM, 'none.json'), 'none.json')):
        done = run(os.path.join(by_meson, 'preview'), *arguments, good=False)
        expect(word in done.stderr, 'preview %s: %s' % (arguments, done.stderr))

lines = [line.split() for line in said[0].splitlines()]
expect(len(lines) == 63, '%d pictures' % len(lines))
rows = [line.split(',') for line in python('squares', FILM, PATTERN).stdout.splitlines()[1:]]
times = [float(row[0]) for row in rows if row[3] == '0']
counts = [sum(abs(t - float(line[1])) < 1e-3 for t in times) for line in lines]
expect(counts == [int(line[3]) for line in lines] and max(counts) > 20,
       'the table has %s squares, the program %s' % (counts, [line[3] for line in lines]))
# a square has its corners in the order of the sheet: clockwise in the picture
corners = numpy.array([[float(x) for x in row[4:6]] for row in rows]).reshape(-1, 4, 2)
sides = numpy.roll(corners, -1, 1) - corners
turn = sides[..., 0] * numpy.roll(sides, -1, 1)[..., 1] - sides[..., 1] * numpy.roll(
    sides, -1, 1)[..., 0]
expect((turn > 0).mean() > 0.99, 'corners go round')

positions = numpy.load(os.path.join(TAKE, 'positions.npy')).astype(float)
table = numpy.loadtxt(python('meshes', TAKE).stdout.splitlines()[1:], delimiter=',')
expect(table.shape == (len(positions), 5), 'a line a frame')
expect((table[:, 1] == numpy.isfinite(positions[..., 0]).sum(1)).all(), 'vertices seen')
expect(abs(table[:, 2:] - numpy.nanmean(positions, 1)).max() < 1e-6, 'means of the places')
for arguments in ((), ('meshes', 'none.take'), ('squares', FILM, 'none.json'), ('else',)):
    expect(python(*arguments, good=False).stderr.strip(), 'metas.py %s says why' % (arguments,))
for fault in faults:
    print('FAULT: ' + fault)
print('%d pictures, %d corners, %d meshes' % (len(lines), len(rows), len(table)))
sys.exit(1 if faults else 0)
