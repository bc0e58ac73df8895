#!/usr/bin/python3
"""Imports recordings of other programs, made here with NumPy, by gst-cloth-take-1.0.

  importtool.py TAKETOOL TESTDATA PAGE

What is read back by NumPy must be what was written, in metres and with z up; what is surely
wrong must be refused with an error that names the mend.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile

import numpy

tool, data, page = (os.path.abspath(path) for path in sys.argv[1:])
drag = os.path.join(data, 'take_drag')
positions = numpy.load(os.path.join(drag, 'positions.npy')).astype(float)
clamps = numpy.load(os.path.join(drag, 'clamps.npy')).astype(float)
positions[7, 40] = positions[8, 41] = numpy.nan
times = numpy.arange(len(positions)) / 50
GRID = ['--columns', '9', '--rows', '9', '--width', '0.4m', '--height', '40cm']
faults = []


def run(*command):
    return subprocess.run((tool,) + command, stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=60, env=dict(os.environ, LC_ALL='C.UTF-8'))


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what))
    if not true:
        faults.append(what)


def write(name, text):
    with open(name, 'w', encoding='utf-8') as file:
        file.write(text)
    return name


def word(value, digits=9):
    return '' if numpy.isnan(value) else '%.*g' % (digits, value)


def long_table(header='time_s,marker,x_m,y_m,z_m', scale=1., names=None, at=times, map=None,
               order=None, separator=','):
    rows = [header]
    for i in range(len(positions)):
        for k in order or range(81):
            place = positions[i, k] * scale
            place = place if map is None else map(place)
            rows.append(separator.join(['%.9g' % at[i], names(k) if names else str(k)] +
                                       [word(x) for x in place]))
    return '\n'.join(rows) + '\n'


def wide_table(name='m%d', suffix='', at=times, extra=None):
    names = [name % k for k in range(81)] + (['grip_l', 'grip_r'] if extra is not None else [])
    rows = ['time_s,' + ','.join('%s_%s%s' % (n, a, suffix) for n in names for a in 'xyz')]
    for i in range(len(positions)):
        places = positions[i] if extra is None else numpy.vstack((positions[i], extra[i]))
        rows.append(','.join(['%.9g' % at[i]] + [word(x) for x in places.ravel()]))
    return '\n'.join(rows) + '\n'


def same(take, what, truth=positions, tolerance=2e-7, at=times):
    got = numpy.load(os.path.join(take, 'positions.npy'))
    when = numpy.load(os.path.join(take, 'times.npy'))
    states = numpy.load(os.path.join(take, 'states.npy'))
    expect(got.shape == truth.shape and (numpy.isnan(got) == numpy.isnan(truth)).all()
           and numpy.nanmax(abs(got - truth)) < tolerance
           and abs(when - at).max() < 1e-6
           and (states == ~numpy.isnan(truth[..., 0])).all(), what)


count = 0


def good(what, source, *options, says=(), grid=GRID, **more):
    global count
    count += 1
    take = 'take%d.take' % count
    done = run('import', source, '--output', take, *grid, *options)
    expect(done.returncode == 0, '%s is read %s' % (what, done.stderr.strip()))
    if done.returncode:
        return None
    for text in says:
        expect(text in done.stdout, '%s: it says “%s”' % (what, text))
    if not all(text in done.stdout for text in says):
        print(done.stdout)
    same(take, what + ': to the bit', **more)
    again = run('info', take)
    expect(again.returncode == 0 and again.stdout in done.stdout, what + ': info says the same')
    return take


def bad(what, source, *options, says=(), grid=GRID, output='bad.take'):
    done = run('import', source, '--output', output, *grid, *options)
    expect(done.returncode in (1, 2) and 'gst-cloth-take-1.0:' in done.stderr,
           '%s is refused: %s' % (what, done.stderr.strip()))
    for text in says:
        expect(text in done.stderr, '%s: “%s” is named' % (what, text))
    expect(not os.path.exists('bad.take'), what + ': nothing is left')


def tables():
    good('a long table', write('long.csv', long_table()),
         says=['60 frames of 81 markers', 'rate        50 a second, even', '9 columns and 9 rows',
               'clamps      none', 'no clamp is given', 'seen        100.0 %, the least 98.8 % in'])
    good('sorted by marker', write('bymarker.csv', '\n'.join(
        [long_table().split('\n')[0]] + sorted(long_table().split('\n')[1:-1],
                                               key=lambda row: int(row.split(',')[1]))) + '\n'))
    good('in any order of markers, by number from 1', write('from1.csv', long_table(
        names=lambda k: str(k + 1), order=list(range(80, -1, -1)))), says=['counted from 1'])
    good('milliseconds and millimetres in the header', write('mm.csv', long_table(
        'Time (ms),Marker,X (mm),Y (mm),Z (mm)', 1000, at=1000 * times)),
        says=['mm, as the file says; metres in the take'], tolerance=1e-6)
    good('millimetres by option, y up', write('yup.csv', long_table(
        'time,vertex,x,y,z', 1000, map=lambda p: (p[0], p[2], -p[1]))),
        '--units', 'mm', '--axes', 'y-up', tolerance=1e-6, says=["source's x,-z,y"])
    good('left-handed', write('left.csv', long_table(map=lambda p: (p[0], p[2], p[1]))),
         '--axes', 'x,z,y', says=['left-handed'])
    good('semicolons, decimal commas, quotes, a mark of UTF-8', write('de.csv', '\ufeff# robot\n'
         + long_table('"t";"point";"x";"y";"z"', separator=';').replace('.', ',')))
    good('tabs', write('tab.txt', long_table('t\tid\tx\ty\tz', separator='\t')))
    good('nan', write('nan.csv', long_table().replace(',,,', ',nan,NaN,NA')))
    good('times of an epoch in nanoseconds', write('epoch.csv', '\n'.join(
        [wide_table().split('\n')[0].replace('time_s', 'stamp_ns')] + [
            '%d,%s' % (1700000000000000000 + round(1e9 * t), row.split(',', 1)[1])
            for t, row in zip(times, wide_table().split('\n')[1:])])), says=['taken off'])
    good('a wide table', write('wide.csv', wide_table()), says=['a line for each frame', 'm0'])
    good('wide, other names', write('wide2.csv', wide_table('marker.%d')))
    good('without times', write('untimed.csv', '\n'.join(
        row.split(',', 1)[1] for row in wide_table().split('\n')[:-1])), '--rate', '50',
        says=['50 frames a second, as given'])
    good('a rate as GStreamer writes it', 'untimed.csv', '--rate', '30000/1001',
         at=numpy.arange(60) * 1001 / 30000, says=['29.97 frames a second, as given'])
    for rate in '0', '-50', 'fifty', '50/', '/2', '50/0', '50/-1', '50/1/1', '50 fps', 'nan', '':
        bad('a rate of “%s”' % rate, 'untimed.csv', '--rate=' + rate, says=['such as 50 or 30000/1001'])
    names = ',' + ',' + ','.join('body:%d,,' % (k + 101) for k in range(81))
    good('names above X, Y, Z', write('vicon.csv', 'Trajectories\n50\n' + names
         + '\nFrame,Sub Frame,' + ','.join(['X,Y,Z'] * 81) + '\n,,' + ','.join(['mm,mm,mm'] * 81)
         + '\n' + '\n'.join('%d,0,' % (i + 1) + ','.join(word(1000 * x) for x in p.ravel())
                            for i, p in enumerate(positions)) + '\n'), '--rate', '50',
         says=['mm, as the file says; metres in the take', 'body:101'], tolerance=1e-6)
    motive = [',Type' + ',Marker' * 243 + ',Rigid Body' * 7,
              ',Name,' + ','.join('velvet %d' % (k + 1) for k in range(81) for _ in 'xyz')
              + ',Hand' * 7,
              ',ID' + ',"4D00"' * 250,
              ',,' + ','.join(['Position'] * 243 + ['Rotation'] * 4 + ['Position'] * 3),
              'Frame,Time (Seconds),' + ','.join(['X,Y,Z'] * 81 + ['X,Y,Z,W,X,Y,Z'])]
    good('names and a rigid body, as OptiTrack writes them', write('motive.csv', (
        'Format Version,1.23,Take Name,hung,Length Units,Meters\n\n' + '\n'.join(motive) + '\n'
        + '\n'.join('%d,%.6f,' % (i, times[i]) + ','.join(
            [word(x) for x in p.ravel()] + ['0', '0', '0', '1'] + [word(x) for x in clamps[i, 0]])
            for i, p in enumerate(positions)) + '\n').replace('velvet 1,', 'velvet 1,')),
         '--clamp', 'velvet 1=Hand', says=['60 frames of 82 markers', 'follows “Hand”'])
    bag = wide_table('field.m%d.position').split('\n')
    good('of a ROS bag', write('bag.csv', '\n'.join(
        ['%time,' + bag[0].replace('_x', '.x').replace('_y', '.y').replace('_z', '.z')
         .partition(',')[2].replace('.position.x', '.position.x', 1)]
        + ['%d,%s' % (1e9 * t, row.partition(',')[2]) for t, row in zip(times, bag[1:])])),
         '--rate', '50', says=['own times are not used'])
    bad('nanoseconds without a name', 'bag.csv', says=['time_ns'])
    lost = [i for i in range(60) if i not in (20, 21)]
    frames = long_table('frame,vertex,x,y,z', at=numpy.arange(60)).split('\n')
    good('lost frames, by number', write('lost.csv', '\n'.join(
        row for row in frames if row.split(',')[0] not in ('20', '21'))), '--rate', '50',
        truth=positions[lost], at=times[lost], says=["by the frames' numbers", '0.02 to 0.06 s'])
    zeros = '\n'.join(','.join(row.split(',')[:2] + ['0', '0', '0']) if row.endswith(',,,') else row
                      for row in long_table().split('\n'))
    good('zeros', write('zeros.csv', zeros), '--zero-is-missing')
    few = '\n'.join(row for row in long_table().split('\n') if ',17,' not in row)
    hidden = positions.copy()
    hidden[:, 17] = numpy.nan
    good('a vertex that is never seen', write('few.csv', few), truth=hidden)


def told():
    """The numbers of the table, by NumPy."""
    drop = os.path.join(data, 'take_drop')
    places = numpy.load(os.path.join(drop, 'positions.npy')).astype(float)
    paths = numpy.load(os.path.join(drop, 'clamps.npy')).astype(float)
    seen = numpy.isfinite(places[..., 0])
    least = seen.mean(1)
    lengths = numpy.nansum(numpy.linalg.norm(numpy.diff(paths, axis=0), axis=2), 0)
    done = run('info', drop)
    lines = dict(line.split(None, 1) for line in done.stdout.splitlines())
    expect(done.returncode == 0 and lines['frames'] == '%d' % len(places), 'frames')
    expect(lines['extent'] == 'x %.3f to %.3f m, y %.3f to %.3f m, z %.3f to %.3f m' % tuple(
        numpy.transpose([numpy.nanmin(places, (0, 1)), numpy.nanmax(places, (0, 1))]).ravel()),
        'extent: ' + lines['extent'])
    expect(lines['seen'] == '%.1f %%, the least %.1f %% in frame %d' % (
        100 * seen.mean(), 100 * least.min(), least.argmin()), 'seen: ' + lines['seen'])
    away = numpy.linalg.norm(paths[:, 0] - places[:, 0], axis=1)
    expect(lines['clamps'] == 'vertex 0, path %.3f m long, %.1f mm from its vertex in the median' % (
        lengths[0], 1000 * numpy.nanmedian(away)), 'clamps: ' + lines['clamps'])
    grid = places.reshape(len(places), 35, 33, 3)
    sides = [
        (numpy.linalg.norm(numpy.diff(grid, axis=2), axis=3) / (0.63 / 32)).reshape(len(grid), -1),
        (numpy.linalg.norm(numpy.diff(grid, axis=1), axis=3) / (0.67 / 34)).reshape(len(grid), -1)]
    for along, side in ((lines['stretch'], sides[0]), (re.search(r'along columns (.*)', done.stdout).group(1), sides[1])):
        stretch = float(re.search(r'are ([\d.]+) times', along).group(1))
        expect(abs(stretch - numpy.nanmedian(side)) < 2e-3, 'stretch: %g' % stretch)
    expect('let go at 0.32 s' in done.stdout, 'let go')


def refused():
    good('a width twice as large', 'long.csv', grid=GRID[:4] + ['--width', '0.8m', '--height', '40cm'],
         says=['note        along rows neighbours are 0.50 times', 'see that its width'])
    bad('millimetres as metres', write('b.csv', long_table(scale=1000, header='t,id,x,y,z')),
        says=['--units mm'])
    bad('metres as millimetres', 'long.csv', '--units', 'mm', says=['--units m'])
    bad('times that go back', write('b.csv', long_table(
        at=numpy.where(times == times[30], 0.1, times))), says=['line 2432', 'goes back', '--rate'])
    bad('a time twice', write('b.csv', wide_table(at=numpy.round(times, 1))),
        says=['comes twice', '--rate'])
    bad('markers in a column that nobody knows', write('b.csv', long_table(header='time,keypoint,x,y,z')),
        says=['comes twice', '“marker”'])
    bad('milliseconds as seconds', write('b.csv', wide_table(at=20000 * times)), says=['time_ms'])
    bad('no time', write('b.csv', '\n'.join(r.split(',', 1)[1] for r in wide_table().split('\n')[:-1])),
        says=['--rate'])
    bad('no mesh', 'long.csv', grid=[], says=['--columns', '--mesh'])
    bad('a grid without size', 'long.csv', grid=GRID[:4], says=['--width'])
    bad('another grid', 'wide2.csv', grid=['--columns', '9', '--rows', '8'] + GRID[4:],
        says=['81 markers', '72'])
    narrow = '\n'.join(r for r in long_table().split('\n')[:1] + [
        r for r in long_table().split('\n')[1:-1] if int(r.split(',')[1]) < 27]) + '\n'
    bad('columns and rows exchanged', write('b.csv', narrow),
        grid=['--columns', '3', '--rows', '9', '--width', '10cm', '--height', '40cm'],
        says=['--columns 9 --rows 3'])
    bad('another size', 'long.csv', grid=GRID[:4] + ['--width', '4m', '--height', '4m'],
        says=['--width'])
    bad('a word', write('b.csv', long_table().replace('0.02,5,', '0.02,5,oops')),
        says=['line 88', 'oops'])
    bad('a short line', write('b.csv', long_table()[:long_table().rindex(',')]), says=['line 4861', 'cells'])
    bad('no header', write('b.csv', '1,2,3,4\n5,6,7,8\n'), says=['time_s,marker,x_m,y_m,z_m'])
    bad('no z', write('b.csv', 'time,a_x,a_y,b_x\n0,1,2,3\n'), says=['“a” has no z'])
    bad('a marker twice', write('b.csv', 'time,id,x,y,z\n0,1,2,3,4\n0,1,2,3,4\n'), says=['twice'])
    bad('units that differ', write('b.csv', 'time,id,x_m,y_mm,z\n0,1,2,3,4\n'), says=['y_mm'])
    bad('nothing but a header', write('b.csv', 'time,id,x,y,z\n'), says=['no frame'])
    with open('b.csv', 'wb') as file:
        file.write(b'PK\3\4\0\0\0')
    bad('a spreadsheet', 'b.csv', says=['table of text'])
    bad('no file', 'none.csv', says=['none.csv'])
    bad('a coordinate beyond', write('b.csv', 'time,id,x,y,z\n0,1,2e20,3,4\n'), says=['no place'])
    for name in 'scene.usda', 'mesh.fbx':
        bad(name, write(name, '#usda 1.0\n(\n    upAxis = "Z"\n)\ndef Mesh "cloth"\n{\n}\n'),
            says=['.c3d, .npy, .obj, .ply and .pc2'])
    bad('axes', 'long.csv', '--axes', 'x,x,z', says=['y-up'])
    bad('units', 'long.csv', '--units', 'miles', says=['mm'])
    bad('a rate', 'long.csv', '--rate', '-3', says=['--rate'])
    bad('a take that is there', 'long.csv', says=['--overwrite'], output='take1.take')
    write('bare.obj', obj_text(0).partition('f ')[0])
    bad('a mesh without faces', 'long.csv', '--mesh', 'bare.obj', grid=[], says=['faces'])
    done = run('import', 'long.csv', *GRID, '--rate', '25', '--output', 'take1.take', '--overwrite')
    expect(done.returncode == 0 and '25 a second, even' in done.stdout, 'it is replaced when asked')
    done = run('import', 'long.csv', *GRID)
    expect(done.returncode == 2 and '--output' in done.stderr, 'no output')
    done = run('info', 'take1.take', '--units', 'mm')
    expect(done.returncode == 2 and 'import' in done.stderr, 'an option of import')
    done = run('info', 'none.take')
    expect(done.returncode == 1 and 'none.take' in done.stderr, 'info of nothing')
    done = run('info')
    expect(done.returncode == 2 and 'TAKE' in done.stderr, 'info without a name')


def held_by_clamps():
    grips = write('grips.csv', 'time_s,left_x,left_y,left_z,right_x,right_y,right_z\n' + ''.join(
        '%.9g,%s\n' % (t, ','.join('%.9g' % x for x in numpy.concatenate(
            [numpy.interp(t, times, clamps[:, c, a]) for c in (0, 1) for a in range(3)],
            axis=None))) for t in numpy.arange(-5, 125) / 100))
    for what, take in (
            ('a log of its own', good('with a log', 'long.csv', '--clamp', '0=left', '--clamp',
                                      '8=right', '--clamp-file', grips,
                                      says=['follows “left”', '0.7 mm from its vertex'])),
            ('markers of the source', good('with grippers', write('grip.csv', wide_table(
                extra=clamps)), '--clamp', 'm0=grip_l', '--clamp', 'm8=grip_r'))):
        got = numpy.load(os.path.join(take, 'clamps.npy'))
        with open(os.path.join(take, 'take.json'), encoding='utf-8') as file:
            held = [item['vertex'] for item in json.load(file)['held']]
        expect(held == [0, 8] and abs(got - clamps).max() < 1e-6, what)
    take = good('by their own places', 'long.csv', '--clamp', '0', '--clamp', '40')
    got = numpy.load(os.path.join(take, 'clamps.npy'))
    expect(abs(got[:, 0] - positions[:, 0]).max() < 1e-6, 'its own places')
    expect(abs(got[7, 1] - (positions[6, 40] + positions[8, 40]) / 2).max() < 1e-6,
           'between its neighbours where it is not seen')
    bad('exchanged clamps', 'long.csv', '--clamp', '8=left', '--clamp-file', grips,
        says=['nearest is vertex 0'])
    far = write('far.csv', open(grips, encoding='utf-8').read().replace('_x', '_x_mm')
                .replace('_y', '_y_mm').replace('_z', '_z_mm'))
    bad('a log in another unit', 'long.csv', '--clamp', '0=left', '--clamp-file', far,
        says=['x_mm'])
    bad('a name that is not there', 'long.csv', '--clamp', '0=up', '--clamp-file', grips,
        says=['“left”, “right”'])
    bad('a vertex that is not there', 'long.csv', '--clamp', '81', says=['0 to 80'])
    bad('one vertex twice', 'long.csv', '--clamp', '8', '--clamp', '8', says=['twice'])
    rows = open(grips, encoding='utf-8').read().split('\n')
    bad('a log that ends early', 'long.csv', '--clamp', '0=left', '--clamp-file',
        write('early.csv', '\n'.join(rows[:60]) + '\n'), says=['not known at', '--clamp-file'])
    bad('a vertex that is never seen', 'few.csv', '--clamp', '17', says=['VERTEX=NAME'])
    done = run('import', write('up.csv', long_table(map=lambda p: (p[0], p[2], -p[1]))), *GRID,
               '--output', 'up.take', '--clamp', '0', '--clamp', '8')
    expect(done.returncode == 0 and '--axes' in done.stdout, 'z is not up: it says so')


def obj_text(frame, uv=True):
    rows = ['v %.9g %.9g %.9g' % tuple(p) for p in numpy.nan_to_num(positions[frame])]
    rows += ['vt %.9g %.9g' % (0.05 * (k % 9), 0.05 * (k // 9)) for k in range(81) if uv]
    for row in range(8):
        for column in range(8):
            a = 9 * row + column + 1
            corners = (a, a + 1, a + 10, a + 9)
            rows.append('f ' + ' '.join('%d/%d' % (c, c) if uv else '%d' % c for c in corners))
    return '\n'.join(rows) + '\n'


def meshes():
    solid = numpy.nan_to_num(positions)
    for i in range(5):
        write('s_%03d.obj' % (i + 1), obj_text(i))
        write('n_%03d.obj' % (i + 1), obj_text(i, False))
        write('p_%d.ply' % i, 'ply\nformat ascii 1.0\nelement vertex 81\nproperty float x\n'
              'property float y\nproperty float z\nend_header\n'
              + ''.join('%.9g %.9g %.9g\n' % tuple(p) for p in solid[i]))
    take = good('numbered OBJ files', 's_001.obj', '--rate', '50', grid=[], truth=solid[:5],
                at=times[:5], says=['numbered OBJ files, 5 frames', 'a mesh of 64 faces'])
    expect(os.path.exists(os.path.join(take, 'mesh.obj')), 'with their mesh')
    good('from the third on', 's_003.obj', '--rate', '50', grid=[], truth=solid[2:5], at=times[:3])
    good('with a grid', 'n_001.obj', '--rate', '50', truth=solid[:5], at=times[:5])
    good('with a mesh', 'n_001.obj', '--rate', '50', '--mesh', 's_001.obj', grid=[],
         truth=solid[:5], at=times[:5])
    good('numbered PLY files', 'p_0.ply', '--rate', '50', truth=solid[:5], at=times[:5])
    numpy.save('a.npy', positions)
    good('NumPy', 'a.npy', '--rate', '50')
    numpy.save('b.npy', positions.astype('f4').reshape(60, 243))
    good('NumPy, flat', 'b.npy', '--rate', '50')
    for i in range(5):
        numpy.save('f_%02d.npy' % (i + 8), positions[i])
    good('numbered NumPy files', 'f_08.npy', '--rate', '50', truth=positions[:5], at=times[:5],
         says=['numbered NumPy files, 5 frames'])
    numpy.save('f_12.npy', positions[4, :80])
    bad('one of another shape', 'f_08.npy', '--rate', '50', says=['f_12.npy', 'another shape'])
    numpy.save('f_12.npy', positions[4].astype(int))
    bad('one of whole numbers', 'f_08.npy', '--rate', '50', says=['f_12.npy', 'another shape'])
    with open('c.pc2', 'wb') as file:
        file.write(struct.pack('<12siiffi', b'POINTCACHE2\0', 1, 81, 0, 1, 60)
                   + solid.astype('<f4').tobytes())
    good('a point cache alone', 'c.pc2', '--rate', '50', truth=solid)
    write('c.obj', obj_text(0))
    good('a point cache with its OBJ file', 'c.pc2', '--rate', '50', grid=[], truth=solid)
    good('a mesh for a point cache', 'c.obj', '--rate', '50', grid=[], truth=solid)
    bad('without uv', 'n_001.obj', '--rate', '50', grid=[], says=['--mesh'])
    bad('a mesh without uv', 'a.npy', '--rate', '50', '--mesh', 'n_001.obj', grid=[], says=['vt'])
    bad('a mesh and a grid', 'a.npy', '--rate', '50', '--mesh', 's_001.obj', says=['either'])
    os.remove('s_003.obj')
    bad('a file that is missing', 's_001.obj', '--rate', '50', grid=[], says=['s_004.obj', 'missing'])
    bad('another mesh', write('s_003.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n') and 's_002.obj',
        '--rate', '50', grid=[], says=['s_003.obj', 'another mesh'])
    numpy.save('d.npy', positions[..., :2])
    bad('an array of pairs', 'd.npy', '--rate', '50', says=['[frames][vertices][3]'])
    bad('no rate', 'a.npy', says=['--rate'])


def parted_text(frame, panel, shrink=1.):
    """The sheet in panels, each of which lies a metre further on the flat cloth."""
    rows = ['v %.9g %.9g %.9g' % tuple(p) for p in numpy.nan_to_num(positions[frame])]
    uv, faces = [], []
    for row in range(8):
        for column in range(8):
            corners = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)]
            number = panel(row, column)
            its = [(number + 0.05 * c, 0.05 * r * (shrink if number else 1)) for r, c in corners]
            rows += ['vt %.9g %.9g' % x for x in its]
            faces.append('f ' + ' '.join('%d/%d' % (9 * r + c + 1, 1 + len(uv) + k)
                                         for k, (r, c) in enumerate(corners)))
            uv += its
    return '\n'.join(rows + faces) + '\n', numpy.array(uv)


def seams():
    """Where a vertex has several uv the take has it several times, sewn together."""
    sources = [9 * (row + r) + column + c for row in range(8) for column in range(8)
               for r, c in ((0, 0), (0, 1), (1, 1), (1, 0))]
    for name, panel, n_lines, more in (
            ('two panels', lambda row, column: int(column > 3), 1, ()),
            ('four panels', lambda row, column: 2 * (row > 3) + (column > 3), 4, ('--clamp', '40')),
            ('a pocket', lambda row, column: int(2 < row < 5 and 2 < column < 5), 2, ()),
            ('every face by itself', lambda row, column: 8 * row + column, 112, ())):
        for i in range(3):
            text, uv = parted_text(i, panel)
            write('seam_%d.obj' % i, text)
        numpy.save('seam.npy', positions[:3])
        for source in ['seam_0.obj'], ['seam.npy', '--mesh', 'seam_0.obj']:
            done = run('import', *source, '--rate', '50', '--output', 'seam.take', '--overwrite', *more)
            said = re.search(r'^seams +(\d+), .* (\d+) vertices more$', done.stdout, re.M)
            if done.returncode or not said or 'note        the seam' in done.stdout:
                expect(False, '%s: %s%s' % (name, done.stdout, done.stderr))
                continue
            with open('seam.take/take.json', encoding='utf-8') as file:
                lines = [item['lines'] for item in json.load(file)['seams']]
            with open('seam.take/mesh.obj', encoding='utf-8') as file:
                rows = file.read().splitlines()
            flat = numpy.array([row.split()[1:] for row in rows if row.startswith('vt')], dtype=float)
            corners = [int(word.split('/')[0]) - 1 for row in rows if row.startswith('f ')
                       for word in row.split()[1:]]
            expect(abs(flat[corners] - uv).max() < 1e-5, name + ': every corner lies where it should')
            places = numpy.load('seam.take/positions.npy')
            truth = positions[:3] if source[0] == 'seam.npy' else numpy.nan_to_num(positions[:3])
            expect(numpy.allclose(places[:, corners], truth[:, sources], atol=2e-7, equal_nan=True)
                   and len(flat) == 81 + int(said.group(2)), name + ': and is where its vertex is')
            same = list(range(len(flat)))
            for line in lines:
                for a, b in zip(*line):
                    same = [same[a] if x == same[b] else x for x in same]
                expect(len(line[0]) == len(line[1]) and all(len(set(side)) == len(side) for side in line),
                       name + ': a line of vertices')
            expect(len(set(same)) == 81 and len({(same[c], s) for c, s in zip(corners, sources)}) == 81,
                   name + ': each vertex is one again')
            expect(len(lines) == int(said.group(1)) == n_lines, '%s: %d seams' % (name, len(lines)))
    gap = os.path.join(os.path.dirname(tool), 'gst-cloth-gap-1.0')
    model = os.path.join(os.path.dirname(page), '../pipelines/model-knit.json')
    for shrink, code in (0.99, 0), (0.9, 1):
        write('seam.obj', parted_text(0, lambda row, column: int(column > 3), shrink)[0])
        done = run('import', 'seam.npy', '--rate', '50', '--mesh', 'seam.obj', '--output', 'seam.take',
                   '--overwrite')
        expect(done.returncode == 0 and ('differ by more than 2 %' in done.stdout) == code,
               'one line shorter by %g: %s' % (1 - shrink, done.stderr))
        done = subprocess.run([gap, 'simulate', model, '--scene', 'seam.take', '--output', 'sewn.take'],
                              capture_output=True, text=True, timeout=120, check=False)
        expect(done.returncode == code and ('of the seam' in done.stderr) == code,
               'a simulation of it: ' + done.stderr[-200:])
    rows = []
    for i in range(3000):
        rows += ['v %d 0 0' % i, 'v %d 1 0' % i, 'v %d 0 1' % i, 'v %d 1 1' % i]
        rows += ['vt %d 0' % i, 'vt %d 1' % i, 'vt %d 2' % i, 'vt %d 3' % i]
        a = 4 * i + 1
        rows += ['f %d/%d %d/%d %d/%d' % (a, a, a + 1, a + 1, a + 2, a + 2),
                 'f %d/%d %d/%d %d/%d' % (a + 1, a + 1, a + 3, a + 3, a + 2, a)]
    bad('too many seams', write('many.obj', '\n'.join(rows) + '\n'), grid=[],
        says=['3000 seams of 6000 pairs', 'fewer pieces'])


def informed():
    """What info notes of a take, whoever made it."""
    def info(width=0.4, places=positions, held=clamps):
        shutil.rmtree('odd.take', ignore_errors=True)
        shutil.copytree(drag, 'odd.take', copy_function=shutil.copyfile)
        with open('odd.take/take.json', encoding='utf-8') as file:
            text = json.load(file)
        text['grid']['width_m'] = width
        with open('odd.take/take.json', 'w', encoding='utf-8') as file:
            json.dump(text, file)
        numpy.save('odd.take/positions.npy', places.astype('f4'))
        numpy.save('odd.take/clamps.npy', held.astype('f4'))
        return run('info', 'odd.take').stdout
    expect('note' not in info() and 'not known' not in info(), 'nothing is odd')
    for width, ratio in (0.44, '0.91'), (0.36, '1.11'):
        told = info(width)
        expect('note        along rows neighbours are %s times' % ratio in told and 'note        along columns'
               not in told and told.count('note') == 1, 'a print of %g m: %s' % (width, told))
    noisy = numpy.random.default_rng(1).normal(positions, 0.01)
    told = info(places=noisy)
    said = [float(x) for x in re.findall(r'noise of about ([.0-9]+) mm would do the same', told)]
    expect(len(said) == 2 and all(8 < x < 12 for x in said), 'noise of 10 mm: ' + told)
    odd = positions.copy()
    odd[:, (numpy.arange(81) // 9 + numpy.arange(81) % 9) % 2 == 1] = numpy.nan
    told = info(places=odd)
    expect('stretch     not known: no neighbours were seen together' in told and 'note' not in told,
           'every other vertex: ' + told)
    told = info(places=positions * [1, 1, -1], held=clamps * [1, 1, -1])
    expect('note        the cloth does not hang below its clamps' in told, 'upside down: ' + told)


def unmerged():
    """Meshes as many programs write them: vertices twice at a seam, and some without a face."""
    def note(name, faces, extra='', move=0):
        rows = ['v %g 0 %g' % (0.1 * (i % 3), 1 - 0.1 * (i // 3)) for i in range(9)] + extra.split('\n')
        for frame in range(2):
            if frame:
                rows[9:] = [row.replace('v 0.1 0 1', 'v 0.1 %g 1' % move) for row in rows[9:]]
            text = ['vt %g %g' % (0.1 * (i % 3), 0.1 * (i // 3)) for i in range(9)]
            text += ['f ' + ' '.join('%d/%d' % corner for corner in face) for face in faces]
            write('%s-%d.obj' % (name, frame), '\n'.join(rows + text) + '\n')
        done = run('import', name + '-0.obj', '--rate', '30', '--output', name + '.take', '--clamp', '0')
        expect(done.returncode == 0, '%s is imported: %s' % (name, done.stderr))
        again = run('info', name + '.take').stdout
        expect(done.stdout.count('note') == again.count('note'), name + ': info says the same')
        return '\n'.join(line for line in done.stdout.splitlines() if line.startswith('note'))
    square = [(0, 3, 4, 1), (1, 4, 5, 2), (3, 6, 7, 4), (4, 7, 8, 5)]
    whole = [[(v + 1, v + 1) for v in face] for face in square]
    expect(note('whole', whole) == '', 'of a whole mesh nothing is noted')
    expect('1 vertices belong to no face, the first is 9: ' in note('loose', whole, 'v 5 5 5'),
           'a vertex without a face')
    # the upper middle vertex, once for the face at its left
    parted = [[(10, uv) if v == 2 else (v, uv) for v, uv in whole[0]]] + whole[1:]
    told = note('parted', parted, 'v 0.1 0 1')
    expect('2 vertices lie where others do, and nothing sews them, the first are 1 and 9' in told and
           'seams' in told, 'a vertex that is there twice: ' + told)
    expect(note('touching', parted, 'v 0.1 0 1', move=0.01) == '', 'what parts later was no copy')


def c3d_bytes(integer, labels=True, rate=50., frames=60):
    """A C3D file, written from the format's description."""
    def parameter(name, group, kind, dimensions, payload):
        rest = struct.pack('<bB', kind, len(dimensions)) + bytes(dimensions) + payload + b'\0'
        return struct.pack('<bb', len(name), group) + name + struct.pack('<H', len(rest) + 2) + rest

    scale = 0.05 if integer else -0.05
    records = parameter(b'USED', 1, 2, [], struct.pack('<h', 81))
    records += parameter(b'FRAMES', 1, 2, [], struct.pack('<h', frames))
    records += parameter(b'SCALE', 1, 4, [], struct.pack('<f', scale))
    records += parameter(b'RATE', 1, 4, [], struct.pack('<f', rate))
    records += parameter(b'DATA_START', 1, 2, [], struct.pack('<h', 5))
    records += parameter(b'UNITS', 1, -1, [2], b'mm')
    if labels:
        records += parameter(b'LABELS', 1, -1, [4, 81], b''.join(b'c%-3d' % k for k in range(81)))
    # the group stands behind its parameters
    records += struct.pack('<bb', 5, -1) + b'POINT' + struct.pack('<HB', 3, 0) + b'\0\0'
    section = struct.pack('<BBBB', 1, 0x50, 3, 84) + records
    head = struct.pack('<BBHHHHHfHHf', 2, 0x50, 81, 2, 1, frames, 10, scale, 5, 1, rate)
    points = b''
    for frame in positions[:frames]:
        for place in frame * 1000:
            lost = numpy.isnan(place[0])
            x, y, z = numpy.zeros(3) if lost else place
            if integer:
                points += struct.pack('<4h', *(int(round(v / 0.05)) for v in (x, y, z)), -int(lost))
            else:
                points += struct.pack('<4f', x, y, z, -1. if lost else 0.)
        # two analog samples of a frame
        points += struct.pack('<2h' if integer else '<2f', 3, 4)
    return head.ljust(512, b'\0') + section.ljust(1536, b'\0') + points


def c3d():
    for integer in False, True:
        with open('r.c3d', 'wb') as file:
            file.write(c3d_bytes(integer))
        good('C3D of %s' % ('whole numbers' if integer else 'floats'), 'r.c3d',
             says=['C3D, 60 frames of 81', 'mm, as the file says; metres in the take', 'rate        50', 'c0'],
             tolerance=4e-5 if integer else 1e-6)
    with open('r.c3d', 'wb') as file:
        file.write(c3d_bytes(False, labels=False))
    good('C3D without labels', 'r.c3d', tolerance=1e-6)
    whole = c3d_bytes(False)
    for what, content, says in (
            ('a C3D file that is cut off', whole[:-100], 'cut short'),
            ('the parameters only', whole[:1000], 'cut short'),
            ('no C3D file', b'\2\0' * 600, 'no C3D'),
            ('a C3D file of a MIPS', whole[:515] + b'\x56' + whole[516:], 'Intel'),
            ('a C3D file without a scale', c3d_bytes(False, rate=float('nan')), 'makes no sense')):
        with open('b.c3d', 'wb') as file:
            file.write(content)
        bad(what, 'b.c3d', says=[says])


def shown():
    """What the page says that is printed."""
    with open(page, encoding='utf-8') as file:
        text = file.read()
    os.symlink(os.path.dirname(data), 'tests')
    robot = 'tests/data/robot_cloth/'
    options = re.search(r'cloth\.csv --output robot\.take \\\n(.*?)```', text, re.S).group(1)
    options = options.replace('\\\n', ' ').replace('$data/', robot).split()
    done = run('import', robot + 'cloth.csv', '--output', 'robot.take', *options)
    expect(done.returncode == 0 and '```text\n%s```' % done.stdout in text, 'the page shows it')
    options.remove('--units')
    options.remove('mm')
    done = run('import', robot + 'cloth.csv', '--output', 'bad.take', *options)
    expect(done.returncode == 1 and done.stderr.partition(': ')[2] in text, 'and its error')
    # The verdict, but for the last digits, which another processor may round otherwise.
    gap = os.path.join(os.path.dirname(tool), 'gst-cloth-gap-1.0')
    model = os.path.join(os.path.dirname(page), '../pipelines/model-knit.json')
    for words in (['simulate', model, '--scene', 'robot.take', '--output', 'simulated.take'],
                  ['compare', 'robot.take', 'simulated.take', '--model', model, '--effects',
                   'air_drag,wind,gravity_tilt', '--output', 'robot-gap']):
        done = subprocess.run([gap, *words], capture_output=True, text=True, timeout=120, check=False)
    said = [line for line in text.splitlines() if line.startswith('explained: ')][0]
    numbers = [[float(x) for x in re.findall(r'[\d.]*\d', line)] for line in (said, done.stdout.split('\n')[0])]
    expect(len(numbers[0]) == len(numbers[1]) and all(abs(a - b) <= max(0.1, 0.03 * a) for a, b in zip(*numbers))
           and re.sub(r'[\d.]*\d', '', said) == re.sub(r'[\d.]*\d', '', done.stdout.split('\n')[0]),
           'the verdict: ' + done.stdout)


with tempfile.TemporaryDirectory(prefix='cloth-import-') as scratch:
    os.chdir(scratch)
    tables()
    told()
    refused()
    held_by_clamps()
    meshes()
    seams()
    informed()
    unmerged()
    c3d()
    shown()
    os.chdir('/')
print('%d faults' % len(faults))
for fault in faults:
    print('FAULT: ' + fault)
sys.exit(1 if faults else 0)
