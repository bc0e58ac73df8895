#!/usr/bin/python3
"""Runs gst-cloth-pattern-1.0 as a user does: good calls, bad calls, equal bytes.

  patterntool.py TOOL VERSION MANPAGE

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import re
import subprocess
import sys
import tempfile

tool, version, manpage = os.path.abspath(sys.argv[1]), sys.argv[2], os.path.abspath(sys.argv[3])
faults = []


def run(folder, *arguments, **variables):
    return subprocess.run([tool, *arguments], cwd=folder, capture_output=True, text=True, timeout=60,
                          env=dict(os.environ, LC_ALL='C.UTF-8', **variables))


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what))
    if not true:
        faults.append(what)


def good_calls(folder):
    done = run(folder, 'checker', '--columns', '8', '--rows', '8', '--square', '50mm',
               '--first', 'black', '--paper', 'A3', '--output', 'board.pdf')
    expect(done.returncode == 0 and not done.stderr, 'a checker on A3 ' + done.stderr)
    expect(done.stdout == 'board.pdf\npattern.json\n', 'names of the files: %r' % done.stdout)
    with open(os.path.join(folder, 'pattern.json'), encoding='utf-8') as file:
        pattern = json.load(file)
    expect(pattern == {'version': 1, 'pattern': 'checker', 'columns': 8, 'rows': 8,
                       'square_m': 0.05, 'origin_uv_m': [0.025, 0.025],
                       'cloth_m': [0.45, 0.45], 'first_square': 'black'}, 'pattern.json: %s' % pattern)
    with open(os.path.join(folder, 'board.pdf'), 'rb') as file:
        expect(file.read(5) == b'%PDF-', 'a PDF')

    calls = []
    for name in ('one', 'two'):
        os.mkdir(os.path.join(folder, name))
        done = run(folder, 'coded-checker', '--columns', '12', '--rows', '10', '--square', '1in',
                   '--margin', '2cm', '--first', 'white', '--seed', '5', '--paper', 'letter',
                   '--output', name + '/board.svg', SOURCE_DATE_EPOCH='1')
        expect(done.returncode == 0, 'a coded checker ' + done.stderr)
        names = done.stdout.split()
        expect(names[-1] == name + '/pattern.json' and len(names) > 2, 'its sheets: %s' % names)
        calls.append([open(os.path.join(folder, at), 'rb').read() for at in names])
    expect(calls[0] == calls[1], 'equal calls give equal bytes')
    pattern = json.loads(calls[0][-1])
    rows = pattern['code']
    expect(len(rows) == 10 and all(re.fullmatch('[01]{12}', row) for row in rows), 'a code')
    expect(abs(pattern['square_m'] - 0.0254) < 1e-15 and pattern['origin_uv_m'] == [0.02, 0.02]
           and pattern['first_square'] == 'white' and pattern['dot_ratio'] == 0.3, 'its numbers')
    left = sorted(os.listdir(os.path.join(folder, 'one')))
    expect(left == sorted(os.path.basename(name) for name in names), 'nothing else is left: %s' % left)

    done = run(folder, 'm-array', '--columns', '14', '--rows', '11', '--pitch', '2cm', '--colours', '4',
               '--two-sided', '--paper', 'A4', '--output', 'dots.pdf')
    expect(done.returncode == 0 and done.stdout == 'dots.pdf\npattern.json\n', 'an M-array ' + done.stderr)
    with open(os.path.join(folder, 'pattern.json'), encoding='utf-8') as file:
        pattern = json.load(file)
    matrix = pattern.pop('matrix')
    expect(pattern == {'version': 1, 'pattern': 'm-array', 'colours': ['cyan', 'magenta', 'yellow', 'orange'],
                       'rgb': [[40, 165, 215], [205, 40, 120], [235, 215, 40], [235, 120, 25]],
                       'pitch_m': 0.02, 'diameter_m': 0.013, 'origin_uv_m': [0.01, 0.01],
                       'cloth_m': [0.28, 0.22], 'columns': 14, 'rows': 11}, 'its pattern.json: %s' % pattern)
    expect(len(matrix) == 11 and all(len(row) == 14 for row in matrix), 'its matrix')


def told(folder):
    done = run(folder, '--version')
    expect(done.returncode == 0 and version in done.stdout, '--version')
    done = run(folder, '--help')
    expect(done.returncode == 0, '--help')
    with open(manpage, encoding='utf-8') as file:
        page = file.read().replace('\\-', '-')
    options = re.findall(r'--[a-z-]+', done.stdout)
    expect(len(options) > 10, 'options in --help')
    for option in sorted(set(options)):
        expect(option in page, 'the manual page has ' + option)
    expect(version in page, "the manual page's version")


BAD_USAGE = [
    ([], 'kind of pattern'),
    (['--output', 'x.pdf'], 'kind of pattern'),
    (['checker', 'checker', '--output', 'x.pdf'], 'kind of pattern'),
    (['chequer', '--output', 'x.pdf'], 'no pattern "chequer"'),
    (['checker'], '--output'),
    (['checker', '--output', 'x.png'], '.pdf or .svg'),
    (['checker', '--output', 'x.pdf', '--frist', 'black'], '--frist'),
    (['checker', '--output', 'x.pdf', '--first', 'red'], 'black or white'),
    (['checker', '--output', 'x.pdf', '--columns', 'eight'], 'eight'),
    (['checker', '--output', 'x.pdf', '--columns', '0'], '1 to 500'),
    (['checker', '--output', 'x.pdf', '--rows', '-3'], '1 to 500'),
    (['checker', '--output', 'x.pdf', '--columns', '501'], '1 to 500'),
    (['checker', '--output', 'x.pdf', '--columns', '99999999999999'], '--columns'),
    (['checker', '--output', 'x.pdf', '--square', '50'], 'with its unit'),
    (['checker', '--output', 'x.pdf', '--square', 'mm'], 'with its unit'),
    (['checker', '--output', 'x.pdf', '--square', '-5mm'], 'with its unit'),
    (['checker', '--output', 'x.pdf', '--square', 'nanmm'], 'with its unit'),
    (['checker', '--output', 'x.pdf', '--square', '0mm'], 'square_m'),
    (['checker', '--output', 'x.pdf', '--margin', '5parsec'], 'with its unit'),
    (['checker', '--output', 'x.pdf', '--paper', 'A9'], 'A0 to A5'),
    (['checker', '--output', 'x.pdf', '--paper', '20x20mm'], 'too small'),
    (['checker', '--output', 'x.pdf', '--square', '5m', '--paper', 'A4'], 'sheets'),
    (['checker', '--output', 'x.pdf', '--square', '5m'], 'paper'),
    (['checker', '--output', 'x.pdf', '--page-margin', '1m'], 'margin'),
    (['checker', '--output', 'x.pdf', '--overlap', '1m'], 'overlap'),
    (['coded-checker', '--output', 'x.pdf', '--columns', '3'], 'at least 4 by 4'),
    (['coded-checker', '--output', 'x.pdf', '--dot-ratio', '1'], 'dot'),
    (['coded-checker', '--output', 'x.pdf', '--dot-ratio', 'nan'], 'dot'),
    (['coded-checker', '--output', 'x.pdf', '--dot-ratio', '0'], 'dot'),
    (['checker', '--output', 'x.pdf', '--pitch', '20mm'], '--pitch is not for'),
    (['checker', '--output', 'x.pdf', '--diameter', '20mm'], '--diameter is not for'),
    (['coded-checker', '--output', 'x.pdf', '--colours', '0'], '--colours is not for'),
    (['checker', '--output', 'x.pdf', '--distance', '2'], '--distance is not for'),
    (['checker', '--output', 'x.pdf', '--two-sided'], '--two-sided is not for'),
    (['checker', '--output', 'x.pdf', '--dot-ratio', '0.2'], '--dot-ratio is not for'),
    (['checker', '--output', 'x.pdf', '--seed', '5'], '--seed is not for'),
    (['m-array', '--output', 'x.pdf', '--square', '20mm'], '--square is not for'),
    (['m-array', '--output', 'x.pdf', '--first', 'black'], '--first is not for'),
    (['m-array', '--output', 'x.pdf', '--dot-ratio', '0.5'], '--dot-ratio is not for'),
    (['m-array', '--output', 'x.pdf', '--pitch', '20'], 'with its unit'),
    (['m-array', '--output', 'x.pdf', '--pitch', '0mm'], 'pitch_m'),
    (['m-array', '--output', 'x.pdf', '--diameter', 'wide'], 'with its unit'),
    (['m-array', '--output', 'x.pdf', '--diameter', '20mm'], 'diameter_m'),
    (['m-array', '--output', 'x.pdf', '--margin', '1mm'], 'the cloth'),
    (['m-array', '--output', 'x.pdf', '--columns', '2'], '3 to 400'),
    (['m-array', '--output', 'x.pdf', '--rows', '401'], '3 to 400'),
    (['m-array', '--output', 'x.pdf', '--colours', '1'], '2 to 8'),
    (['m-array', '--output', 'x.pdf', '--colours', '9'], '2 to 8'),
    (['m-array', '--output', 'x.pdf', '--distance', '0'], 'distance'),
    (['m-array', '--output', 'x.pdf', '--distance', '6'], 'distance'),
    (['m-array', '--output', 'x.pdf', '--colours', '3'], 'at most 2460'),
    (['m-array', '--output', 'x.pdf', '--pitch', '3cm'], 'paper'),
    (['m-array', '--output', 'x.pdf', '--paper', 'A5'], 'sheets'),
]


def garments(folder):
    drawing = os.path.join(os.path.dirname(os.path.abspath(__file__)), '../../pipelines/skirt.svg')
    done = run(folder, 'm-array', '--rows', '40', '--output', 'dots.svg')
    expect(done.returncode == 0, 'dots: %r' % done.stderr)
    done = run(folder, 'garment', drawing, '--pattern', 'pattern.json', '--output', 'skirt')
    expect(done.returncode == 0 and done.stdout == 'skirt/garment.json\nskirt/garment.obj\n',
           'a skirt: %r %r' % (done.stdout, done.stderr))
    with open(os.path.join(folder, 'skirt/garment.json'), encoding='utf-8') as file:
        garment = json.load(file)
    with open(os.path.join(folder, 'skirt/garment.obj'), encoding='utf-8') as file:
        lines = [line.split() for line in file]
    places = [line[1:] for line in lines if line and line[0] == 'v']
    expect(len(garment['dots']) == len(places) and len(garment['panels']) == 2, 'as many dots as vertices')
    for place, dot in zip(places, garment['dots']):
        if dot >= 0 and (abs(float(place[0]) - 0.01 - 0.02 * (dot % 76)) > 1e-5 or
                         abs(-float(place[2]) - 0.01 - 0.02 * (dot // 76)) > 1e-5):
            expect(False, 'dot %d is not at %s' % (dot, place))
            break
    for seam in garment['seams']:
        expect(len(seam['lines'][0]) == len(seam['lines'][1]), 'both sides of ' + seam['name'])
    # from a print that is too small nothing comes
    os.mkdir(os.path.join(folder, 'small'))
    run(folder, 'm-array', '--rows', '20', '--columns', '20', '--output', 'small/dots.svg')
    done = run(folder, 'garment', drawing, '--pattern', 'small/pattern.json', '--output', 'none')
    expect(done.returncode == 1 and 'leaves the printed cloth' in done.stderr, 'too small: %r' % done.stderr)
    expect(not os.path.exists(os.path.join(folder, 'none')), 'nothing is left of a refused garment')
    for arguments, code, says in (
            (['garment'], 2, 'name the drawing'),
            (['garment', drawing, '--output', 'x'], 2, '--pattern'),
            (['garment', drawing, '--pattern', 'pattern.json'], 2, '--output'),
            (['garment', 'no.svg', '--pattern', 'pattern.json', '--output', 'x'], 1, 'no.svg'),
            (['garment', drawing, '--pattern', 'no.json', '--output', 'x'], 1, 'no.json'),
            (['garment', 'pattern.json', '--pattern', 'pattern.json', '--output', 'x'], 1, 'pattern.json'),
            (['garment', drawing, '--pattern', 'pattern.json', '--output', 'x', '--rows', '9'], 2,
             '--rows is not for'),
            (['garment', drawing, '--pattern', 'pattern.json', '--output', 'x', '--paper', 'A4'], 2,
             '--paper is not for'),
            (['m-array', '--pattern', 'pattern.json', '--output', 'x.svg'], 2, '--pattern is not for')):
        done = run(folder, *arguments)
        expect(done.returncode == code and says in done.stderr and not done.stdout,
               '%s: %d %r' % (' '.join(arguments), done.returncode, done.stderr))


def bad_calls(folder):
    for arguments, says in BAD_USAGE:
        done = run(folder, *arguments)
        expect(done.returncode == 2 and says in done.stderr and not done.stdout,
               '%s: %d %r' % (' '.join(arguments), done.returncode, done.stderr))
    done = run(folder, 'checker', '--output', 'nowhere/board.pdf')
    expect(done.returncode == 1 and 'nowhere/board.pdf' in done.stderr, 'no such folder: %r' % done.stderr)
    done = run(folder, 'm-array', '--columns', '40', '--rows', '40', '--distance', '4', '--output', 'x.pdf')
    expect(done.returncode == 1 and 'less distance' in done.stderr, 'a code that is not found: %r' % done.stderr)
    os.makedirs(os.path.join(folder, 'taken', 'pattern.json'))
    done = run(folder, 'checker', '--output', 'taken/board.svg')
    expect(done.returncode == 1 and 'pattern.json' in done.stderr, 'a folder in the way: %r' % done.stderr)
    left = [name for _, _, names in os.walk(folder) for name in names]
    expect(left == ['board.svg'], 'nothing half-written is left: %s' % left)


for calls in (good_calls, told, garments, bad_calls):
    with tempfile.TemporaryDirectory(prefix='cloth-pattern-') as place:
        calls(place)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
