#!/usr/bin/python3
"""Runs gst-cloth-pattern-1.0 as a user does: good calls, bad calls, equal bytes.

  patterntool.py TOOL VERSION MANPAGE

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import re
import struct
import subprocess
import sys
import tempfile
import zlib

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

    os.mkdir(os.path.join(folder, 'dots'))
    done = run(folder, 'm-array', '--columns', '14', '--rows', '11', '--pitch', '2cm', '--colours', '4',
               '--two-sided', '--paper', 'A4', '--output', 'dots/dots.pdf')
    expect(done.returncode == 0 and done.stdout == 'dots/dots.pdf\ndots/pattern.json\n',
           'an M-array ' + done.stderr)
    with open(os.path.join(folder, 'dots/pattern.json'), encoding='utf-8') as file:
        pattern = json.load(file)
    matrix = pattern.pop('matrix')
    expect(pattern == {'version': 1, 'pattern': 'm-array', 'colours': ['cyan', 'magenta', 'yellow', 'orange'],
                       'rgb': [[40, 165, 215], [205, 40, 120], [235, 215, 40], [235, 120, 25]],
                       'pitch_m': 0.02, 'diameter_m': 0.013, 'origin_uv_m': [0.01, 0.01],
                       'cloth_m': [0.28, 0.22], 'columns': 14, 'rows': 11}, 'its pattern.json: %s' % pattern)
    expect(len(matrix) == 11 and all(len(row) == 14 for row in matrix), 'its matrix')


def other_prints(folder):
    folder = os.path.join(folder, 'prints')
    os.mkdir(folder)

    def content():
        with open(os.path.join(folder, 'pattern.json'), 'rb') as file:
            return file.read()

    board = ['checker', '--columns', '9', '--rows', '6']
    expect(run(folder, *board, '--output', 'board.pdf').returncode == 0, 'a first print')
    first = content()
    for call in (['coded-checker', '--columns', '9', '--rows', '6', '--output', 'cloth.pdf'],
                 ['checker', '--columns', '9', '--rows', '7', '--output', 'cloth.svg'],
                 ['m-array', '--columns', '9', '--rows', '6', '--output', 'cloth.pdf'],
                 ['picture', '--width', '20cm', '--output', 'cloth.pdf']):
        done = run(folder, *call)
        expect(done.returncode == 1 and done.stderr.count('\n') == 1
               and 'pattern.json is of another print' in done.stderr and '--output NEW/cloth' in done.stderr,
               'another print beside it: ' + done.stderr)
        expect(content() == first and sorted(os.listdir(folder)) == ['board.pdf', 'pattern.json'],
               'the first one stays, alone')
    done = run(folder, *board, '--output', 'board.svg', '--paper', 'A5')
    expect(done.returncode == 0 and content() == first, 'the same pattern on other paper')
    for columns in ('8', '7'):
        done = run(folder, 'checker', '--columns', columns, '--rows', '6', '--output', 'board.svg')
        expect(done.returncode == 0 and json.loads(content())['columns'] == int(columns),
               'the same print anew ' + done.stderr)


def pictures(folder):
    calls = []
    for name in ('three', 'four'):
        os.mkdir(os.path.join(folder, name))
        done = run(folder, 'picture', '--width', '20cm', '--height', '15cm', '--seed', '4', '--sides', '2',
                   '--output', name + '/sheet.svg', SOURCE_DATE_EPOCH='1')
        names = done.stdout.split()
        expect(done.returncode == 0 and names == [name + '/sheet.svg', name + '/reference.png',
                                                  name + '/pattern.json'], 'a sheet %s' % names)
        expect(re.fullmatch(r'[0-9]{3,4} features, [0-4]% of them repeated elsewhere on the print\n',
                            done.stderr), 'its features: %r' % done.stderr)
        calls.append([open(os.path.join(folder, at), 'rb').read() for at in names])
    expect(calls[0] == calls[1], 'equal calls give equal bytes')
    expect(re.search(rb'width="220mm" height="195mm"', calls[0][0]), 'at true size, with margins')
    pattern = json.loads(calls[0][2])
    expect(pattern == {'version': 1, 'pattern': 'picture', 'reference': 'reference.png',
                       'cloth_m': [0.2, 0.15], 'columns': 11, 'rows': 9, 'sides': 2},
           'its pattern.json: %s' % pattern)
    expect(struct.unpack('>II', calls[0][1][16:24]) == (300, 225), 'its picture, 1.5 px a mm')

    done = run(folder, 'picture', 'three/reference.png', '--width', '400mm', '--columns', '9',
               '--output', 'three/other.json')
    expect(done.returncode == 0 and done.stdout == 'three/other.json\n', 'a scan beside it: %r' % done.stdout)
    with open(os.path.join(folder, 'three/other.json'), encoding='utf-8') as file:
        pattern = json.load(file)
    expect(pattern == {'version': 1, 'pattern': 'picture', 'reference': 'reference.png',
                       'cloth_m': [0.4, 0.3], 'columns': 9, 'rows': 16, 'sides': 1},
           'height and rows by the shape: %s' % pattern)
    os.rename(os.path.join(folder, 'three/reference.png'), os.path.join(folder, 'three/scan.png'))
    os.mkdir(os.path.join(folder, 'five'))
    done = run(folder, 'picture', 'three/scan.png', '--width', '20cm', '--height', '15cm',
               '--output', 'five/pattern.json')
    expect(done.returncode == 0 and done.stdout == 'five/reference.png\nfive/pattern.json\n',
           'a scan from elsewhere: %r' % done.stdout)
    with open(os.path.join(folder, 'five/reference.png'), 'rb') as file:
        expect(file.read() == calls[0][1], 'is copied')

    # A tile of 50 by 45 mm, four times across and down, on a plain ground.
    pixels = zlib.decompress(b''.join(chunks(calls[0][1], b'IDAT')))
    rows = unfilter(pixels, 225, 3 * 300, 3)
    tile = [bytes(row[3 * x] for x in range(75)) * 4 for row in rows[:67]] * 4
    with open(os.path.join(folder, 'repeats.pgm'), 'wb') as file:
        file.write(b'P5 300 268 255\n' + b''.join(tile))
    with open(os.path.join(folder, 'plain.pgm'), 'wb') as file:
        file.write(b'P5 300 268 255\n' + bytes([200]) * 300 * 268)
    done = run(folder, 'picture', 'repeats.pgm', '--width', '20cm', '--output', 'repeats.json')
    expect(done.returncode == 0 and 'Warning: most of this print is repeated' in done.stderr,
           'a print that repeats: %r' % done.stderr)
    for scan, width, output, says in ((
            'plain.pgm', '20cm', 'plain.json', 'no feature'), (
            'nowhere.png', '20cm', 'plain.json', 'no such file'), (
            'repeats.json', '20cm', 'plain.json', 'repeats.json'), (
            'repeats.pgm', '20cm', 'nowhere/pattern.json', 'nowhere')):
        done = run(folder, 'picture', scan, '--width', width, '--output', output)
        expect(done.returncode == 1 and says in done.stderr
               and not os.path.exists(os.path.join(folder, output)), '%s: %r' % (scan, done.stderr))
    done = run(folder, 'picture', 'repeats.pgm', '--width', '20cm', '--height', '30cm', '--output', 'x.json')
    expect(done.returncode == 1 and 'no picture of 0.2' in done.stderr, 'another shape: %r' % done.stderr)


def chunks(png, kind):
    at = 8
    while at < len(png):
        length = struct.unpack('>I', png[at:at + 4])[0]
        if png[at + 4:at + 8] == kind:
            yield png[at + 8:at + 8 + length]
        at += 12 + length


def unfilter(pixels, height, stride, step):
    """The rows of a PNG without its five kinds of prediction."""
    rows, above = [], bytearray(stride)
    for y in range(height):
        kind, row = pixels[y * (stride + 1)], bytearray(pixels[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left, up = row[x - step] if x >= step else 0, above[x]
            corner = above[x - step] if x >= step else 0
            near = min((left, up, corner), key=lambda v: abs(left + up - corner - v))
            row[x] = (row[x] + (0, left, up, (left + up) // 2, near)[kind]) % 256
        rows.append(row)
        above = row
    return rows


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
    (['picture', '--output', 'x.pdf'], '--width 630mm'),
    (['picture', 'scan.png', '--output', 'x.json'], '--width 630mm'),
    (['picture', 'scan.png', '--width', '1m'], '--output pattern.json'),
    (['picture', 'scan.png', '--width', '1m', '--output', 'x.pdf'], '.json'),
    (['picture', 'a.png', 'b.png', '--width', '1m', '--output', 'x.json'], 'one scan'),
    (['picture', 'scan.png', '--width', '1m', '--seed', '3', '--output', 'x.json'], 'from a scan'),
    (['picture', 'scan.png', '--width', '1m', '--paper', 'A4', '--output', 'x.json'], 'from a scan'),
    (['picture', '--width', '1m', '--output', 'x.json'], '.pdf or .svg'),
    (['picture', '--width', '1', '--output', 'x.pdf'], 'with its unit'),
    (['picture', '--width', '1m', '--height', 'tall', '--output', 'x.pdf'], 'with its unit'),
    (['picture', '--width', '1m', '--height', '0mm', '--output', 'x.pdf'], 'leave it out'),
    (['picture', '--width', '4m', '--output', 'x.pdf'], '0.05 to 3 m'),
    (['picture', '--width', '1m', '--height', '1mm', '--output', 'x.pdf'], '0.05 to 3 m'),
    (['picture', '--width', '1m', '--square', '1cm', '--output', 'x.pdf'], '--square is not for'),
    (['picture', '--width', '1m', '--two-sided', '--output', 'x.pdf'], '--two-sided is not for'),
    (['picture', '--width', '10cm', '--sides', '3', '--output', 'x.pdf'], '3 sides'),
    (['picture', '--width', '10cm', '--columns', '1', '--output', 'x.pdf'], '2 to 500'),
    (['checker', '--width', '10cm', '--output', 'x.pdf'], '--width is not for'),
    (['m-array', '--sides', '2', '--output', 'x.pdf'], '--sides is not for'),
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
            (['garment', drawing, '--pattern', 'pattern.json', '--output', 'pattern.json'], 1, 'Not a directory'),
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


for calls in (good_calls, other_prints, pictures, told, garments, bad_calls):
    with tempfile.TemporaryDirectory(prefix='cloth-pattern-') as place:
        calls(place)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
