#!/usr/bin/python3
"""Are the windows of generated M-arrays unique? Every window is looked at, in pictures of
nine characters that are turned as pictures; nothing is shared with the generator.

  marrayunique.py TOOL

Two windows differ by less than d dots when they agree in some 9 - d + 1 of their nine
places: so windows are sorted by what they show in each choice of places.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import itertools
import json
import os
import subprocess
import sys
import tempfile

tool = os.path.abspath(sys.argv[1])
# Walking round the rim of a window clockwise from its top-left dot.
RIM = ((0, 0), (0, 1), (0, 2), (1, 2), (2, 2), (2, 1), (2, 0), (1, 0))
faults = []


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what))
    if not true:
        faults.append(what)


def turned(window):
    """Each dot of the rim moves on to the next place: 45 degrees."""
    out = [list(line) for line in window]
    for (r, c), (to_r, to_c) in zip(RIM, RIM[1:] + RIM[:1]):
        out[to_r][to_c] = window[r][c]
    return tuple(map(tuple, out))


def looks(window, two_sided):
    for face in (window, tuple(line[::-1] for line in window))[:2 if two_sided else 1]:
        for _ in range(8):
            yield sum(face, ())
            face = turned(face)


def clashes(matrix, distance, two_sided):
    """Pairs of looks, of one window or of two, that differ by less than the distance."""
    found = []
    all_looks = []
    for r in range(len(matrix) - 2):
        for c in range(len(matrix[0]) - 2):
            window = tuple(tuple(line[c:c + 3]) for line in matrix[r:r + 3])
            all_looks += [((r, c, n), look) for n, look in enumerate(looks(window, two_sided))]
    for places in itertools.combinations(range(9), 10 - distance):
        seen = {}
        for place, look in all_looks:
            key = tuple(look[i] for i in places)
            if key in seen:
                found.append((seen[key], place))
            seen[key] = place
    return found


def generate(folder, columns, rows, colours=5, distance=1, two_sided=False, seed=1):
    subprocess.run([tool, 'm-array', '--columns', str(columns), '--rows', str(rows),
                    '--colours', str(colours), '--distance', str(distance), '--seed', str(seed),
                    '--output', 'dots.svg'] + ['--two-sided'] * two_sided,
                   cwd=folder, check=True, stdout=subprocess.DEVNULL, timeout=120)
    with open(os.path.join(folder, 'pattern.json'), encoding='utf-8') as file:
        pattern = json.load(file)
    matrix = pattern['matrix']
    expect(len(matrix) == rows and all(len(line) == columns for line in matrix)
           and {dot for line in matrix for dot in line} <= set(range(colours)), 'size and colours')
    return matrix


CASES = (dict(columns=76, rows=251), dict(columns=76, rows=251, two_sided=True),
         dict(columns=76, rows=251, colours=4), dict(columns=251, rows=76, seed=9),
         dict(columns=3, rows=3), dict(columns=3, rows=100), dict(columns=30, rows=30, colours=3),
         dict(columns=40, rows=40, distance=2), dict(columns=20, rows=24, distance=2, two_sided=True),
         dict(columns=18, rows=18, distance=3), dict(columns=9, rows=9, distance=4),
         dict(columns=12, rows=12, distance=3, colours=8, two_sided=True))

with tempfile.TemporaryDirectory(prefix='cloth-marray-') as place:
    for case in CASES:
        found = clashes(generate(place, **case), case.get('distance', 1), case.get('two_sided', False))
        expect(not found, '%s: %d clashes %s' % (case, len(found), found[:3]))
    # The check sees what it is for: a window copied, turned, mirrored, one that equals its own half turn.
    small = generate(place, 30, 30, two_sided=True)
    for what, two_sided, change in (
            ('a copy', False, lambda w: w), ('a turn', False, lambda w: turned(turned(turned(w)))),
            ('a mirror image', True, lambda w: tuple(line[::-1] for line in w)),
            ('a half turn', False, lambda w: ((0, 1, 2), (3, 4, 3), (2, 1, 0)))):
        spoilt = [list(line) for line in small]
        window = change(tuple(tuple(line[4:7]) for line in small[5:8]))
        for i in range(3):
            spoilt[20 + i][11:14] = window[i]
        expect(clashes(spoilt, 1, two_sided), what + ' is seen')
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
