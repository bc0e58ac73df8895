#!/usr/bin/env python3
"""Prints the coverage of each room, of each parser and of the commits of files, from gcov's counts.

  tests/coverage.py BUILD-FOLDER

A branch that g_assert (), g_return_* (), g_new (), g_clear_* () or G_DEFINE_* () makes is not counted:
no input takes it. Neither is what frees a g_autoptr or g_autofree: the compiler puts it on the lines
where the variable is declared, where something is returned and where a block ends; one of these that
holds a condition of ours is counted. A source that is compiled several times counts as covered where
any of its objects is.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import collections
import json
import os
import re
import subprocess
import sys

# What reads bytes that nobody vouches for, and what gives files their names.
PARSERS = [
    'gst/file/json.c', 'gst/file/npy.c', 'gst/pattern/pattern.c', 'gst/pattern/marray.c',
    'gst/pattern/picture.c', 'gst/pattern/patternjson.c',
    'gst/rig/rigfile.c', 'gst/rig/rigyaml.c', 'gst/rig/cameramodel.c', 'gst/rig/world.c', 'gst/rig/yamltree.c', 'gst/mesh/formats/obj.c',
    'gst/mesh/formats/pc2.c', 'gst/mesh/formats/ply.c', 'gst/take/take-info.c', 'gst/take/take.c',
    'gst/take/obstacle.c', 'gst/take/sequence.c', 'gst/sim/model.c', 'gst/cloth/gstclothmesh.c',
    'gst/cloth/gstclothobservations.c', 'gst/cloth/gstclothtopology.c',
    'gst/cloth-io/observations.c', 'tools/tool.c']
# Branches of parsers that no test takes: file, what, why it is left in.
FREES = 'frees nothing', 'every release function takes NULL; g_autoptr asks by itself'
FOLDED = ('an impossible half of a condition',
          'the compiler has answered it at a line before, or knows not that a refusal is FALSE')
BUFFERED = 'a failed write of a header', 'it stays in the buffer: a later write or the end fails'
UNREACHED = [
    ('gst/file/json.c', *FOLDED),
    ('gst/file/npy.c', 'the type of the caller, or none, where types are converted',
     'rows of that type are read as they are; the compiler warns of a type that is missing'),
    ('gst/file/npy.c', *BUFFERED),
    ('gst/pattern/pattern.c', *FREES),
    ('gst/pattern/pattern.c', *FOLDED),
    ('gst/pattern/pattern.c', 'a number that 17 digits are too few for', 'there is none'),
    ('gst/pattern/pattern.c', 'a pattern without a code', 'an inline function asks once more'),
    ('gst/pattern/marray.c', *FREES),
    ('gst/pattern/marray.c', *FOLDED),
    ('gst/pattern/marray.c', 'a search that goes back beyond the first dot',
     'it would have tried each colour of all the others'),
    ('gst/pattern/picture.c', *FREES),
    ('gst/pattern/picture.c', *FOLDED),
    ('gst/rig/yamltree.c', *FREES),
    ('gst/rig/yamltree.c', 'no memory for libyaml', 'GLib has ended the program by then'),
    ('gst/mesh/formats/obj.c', '8,000,000 uv', '56 MB of text'),
    ('gst/mesh/formats/pc2.c', *BUFFERED),
    ('gst/mesh/formats/pc2.c', '2,147,483,647 samples', '25 GB'),
    ('gst/mesh/formats/ply.c', 'a value of no type', 'the header has only known ones'),
    ('gst/mesh/formats/ply.c', *BUFFERED),
    ('gst/take/take-info.c', *FOLDED),
    ('gst/take/take-info.c', 'an obstacle of no kind', 'the enumeration has no other'),
    ('gst/take/take.c', *FREES),
    ('gst/take/take.c', 'times.npy that cannot be read', 'its size was compared when it was opened'),
    ('gst/take/take.c', 'a failed write of take.json', 'it stays in the buffer: the end fails'),
    ('gst/take/sequence.c', *FREES),
    ('gst/cloth/gstclothobservations.c', *FOLDED),
    ('gst/cloth/gstclothobservations.c', 'a reference without a name', 'no caps are so short'),
    ('gst/cloth/gstclothtopology.c', *FOLDED),
    ('gst/cloth-io/observations.c', *FOLDED),
    ('gst/cloth-io/observations.c', 'GStreamer that does not start', 'the tests need it'),
    ('tools/tool.c', 'progress on a terminal after its end', 'what is counted is an estimate')]
COMMITS = ['gst/file/output.c', 'gst/file/parts.c', 'gst/file/commit.c', 'gst/file/remains.c',
           'gst/file/reopen.c', 'gst/take/recover.c']
LINES, BRANCHES, COMMIT = 90, 95, 100
GUARD = re.compile(r'\bg_(assert|return|new|renew|clear)\w* \(|^G_DEFINE_'
                   r'|^\s*(\}|(return|g_auto\w*) (?!.*(\?|&&|\|\|)).*[=;])$')

root = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..')
build = os.path.abspath(sys.argv[1])


class Source:
    """What was run of one file, by the numbers of its lines."""

    def __init__(self, path):
        with open(os.path.join(root, path), encoding='utf-8') as file:
            self.text = file.read().split('\n')
        self.lines = collections.Counter()
        self.branches = collections.Counter()

    def add(self, line):
        number = line['line_number']
        self.lines[number] += line['count']
        if GUARD.search(self.text[number - 1]):
            return
        for i, branch in enumerate(line['branches']):
            self.branches[number, i] += branch['count']


def read(build):
    """All sources of the project that the build has compiled."""
    sources = {}
    notes = [os.path.join(folder, name) for folder, _, names in os.walk(build)
             for name in names if name.endswith('.gcno') and '/tests/' not in folder]
    for first in range(0, len(notes), 50):
        out = subprocess.run(['gcov', '--json-format', '--stdout', '--branch-probabilities']
                             + notes[first:first + 50], cwd=build, check=True, text=True,
                             stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
        for report in filter(None, out.split('\n')):
            for file in json.loads(report)['files']:
                path = os.path.relpath(os.path.join(build, file['file']), root)
                if path.startswith(('..', 'build')) or not path.endswith('.c'):
                    continue
                source = sources.setdefault(path, Source(path))
                for line in file['lines']:
                    source.add(line)
    return sources


def share(counters):
    """Percent of what was run at least once, and of how many."""
    counts = [count for counter in counters for count in counter.values()]
    return 100 * sum(count > 0 for count in counts) / max(1, len(counts)), len(counts)


def row(name, sources):
    lines, n_lines = share(source.lines for source in sources)
    branches, n_branches = share(source.branches for source in sources)
    print('%-38s %6.1f%% of %6d %6.1f%% of %6d' % (name, lines, n_lines, branches, n_branches))
    return lines, branches


def room_of(path):
    parts = path.split('/')
    return '/'.join(parts[:2]) if parts[0] == 'gst' else parts[0]


sources = read(build)
if not sources:
    sys.exit('no counts in ' + build)
below = []
print('%-38s %17s %17s' % ('room', 'lines', 'branches'))
rooms = collections.defaultdict(list)
for path, source in sources.items():
    rooms[room_of(path)].append(source)
for room in sorted(rooms):
    if row(room, rooms[room])[0] < LINES:
        below.append(room + ': lines')
print('\n%-38s %17s %17s' % ('parser', 'lines', 'branches'))
for path in PARSERS:
    if row(path, [sources[path]])[1] < BRANCHES:
        below.append(path + ': branches')
print('\n%-38s %17s %17s' % ('commit', 'lines', 'branches'))
for path in COMMITS:
    if min(row(path, [sources[path]])) < COMMIT:
        below.append(path)
print('\nNot reached in the parsers, and why it is there:')
for path, what, why in UNREACHED:
    print('  %s: %s: %s' % (path, what, why))
with open(os.path.join(build, 'uncovered.txt'), 'w', encoding='utf-8') as file:
    for path in sorted(sources):
        source = sources[path]
        dark = {number for number, count in source.lines.items() if not count}
        halves = {number for (number, _), count in source.branches.items() if not count} - dark
        for number in sorted(dark | halves):
            file.write('%s:%d: %s: %s\n' % (path, number, 'line' if number in dark else 'branch',
                                            source.text[number - 1].strip()))
print('\nBelow the aims (lines of a room %d%%, branches of a parser %d%%, commits %d%%): %s'
      % (LINES, BRANCHES, COMMIT, ', '.join(below) or 'none'))
sys.exit(1 if below else 0)
