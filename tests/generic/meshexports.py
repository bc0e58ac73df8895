#!/usr/bin/python3
"""What meshsink writes for other programs, read by the books: each format by a small reader
made from its specification, which shares nothing with the writer.

  meshexports.py

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import csv
import json
import os
import re
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

import numpy as np

COLUMNS, ROWS, FRAMES = 24, 12, 9
N = COLUMNS * ROWS
FPS = 25
faults = []


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what))
    if not true:
        faults.append(what)


# ---- the truth: a sheet of quads, one of which is cut, that waves and is partly unseen

def make_take(folder):
    column, row = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS))
    uv = np.stack([column.ravel() * 0.02, row.ravel() * 0.02], 1).astype('f4')
    faces = [[r * COLUMNS + c, (r + 1) * COLUMNS + c, (r + 1) * COLUMNS + c + 1, r * COLUMNS + c + 1]
             for r in range(ROWS - 1) for c in range(COLUMNS - 1)]
    first = faces.pop(0)
    faces += [first[:3], [first[0], first[2], first[3]]]
    # one frame is lost between 4 and 5
    times = np.array([f if f < 5 else f + 1 for f in range(FRAMES)]) / FPS
    positions = np.empty((FRAMES, N, 3), 'f4')
    for f in range(FRAMES):
        positions[f, :, 0] = uv[:, 0] - 0.2
        positions[f, :, 1] = 0.03 * np.sin(20 * uv[:, 0] + f) + 1
        positions[f, :, 2] = 1.5 - uv[:, 1] + 0.001 * f
    states = np.empty((FRAMES, N), 'u1')
    states[:] = 1 + np.arange(N) % 4
    states[:, 7] = 0                # never seen
    states[2:5, 30] = 0
    covariance = np.zeros((FRAMES, N, 6), 'f4')
    sigma = (0.0001 + 0.00001 * np.arange(N)).astype('f4')
    covariance[:, :, [0, 3, 5]] = (sigma ** 2)[None, :, None]
    covariance[:, 50] = np.nan      # place known, its error not
    positions[states == 0] = np.nan
    covariance[states == 0] = np.nan
    os.mkdir(folder)
    json.dump({'version': 1, 'name': 'sheet', 'fps': FPS, 'mesh': 'mesh.obj'},
              open(os.path.join(folder, 'take.json'), 'w'))
    with open(os.path.join(folder, 'mesh.obj'), 'w') as obj:
        for u, v in uv:
            obj.write('v %.9g %.9g 0\n' % (u, v))
        for u, v in uv:
            obj.write('vt %.9g %.9g\n' % (u, v))
        for face in faces:
            obj.write('f %s\n' % ' '.join('%d/%d' % (i + 1, i + 1) for i in face))
    for name, array in (('positions', positions), ('states', states), ('times', times),
                        ('covariance', covariance)):
        np.save(os.path.join(folder, name + '.npy'), array)
    # what a format without NaN shows instead: the last place
    held = positions.copy()
    held[:, 7] = np.nan
    for f in range(2, 5):
        held[f, 30] = held[1, 30]
    sigma = np.where(states == 0, np.nan, sigma[None, :]).astype('f4')
    sigma[:, 50] = np.nan
    strain = [strains(uv.astype('f8'), faces, frame.astype('f8')) for frame in positions]
    return {'uv': uv, 'faces': faces, 'times': times, 'positions': positions, 'states': states,
            'held': held, 'sigma': sigma, 'face_strain': np.array([s[0] for s in strain]),
            'strain': np.array([s[1] for s in strain])}


def strains(uv, faces, places):
    """Green–Lagrange strain of faces and vertices. The quads are rectangles along u and v, so that
    warp and weft follow from the lengths of their edges, and shear from the angles between."""
    of_faces, sums = np.full((len(faces), 3), np.nan), np.zeros((N, 4))
    for f, face in enumerate(faces):
        x, flat = places[face], uv[face]
        if len(face) == 3:
            gradient = np.linalg.solve(flat[1:] - flat[0], x[1:] - x[0]).T
            e = (gradient.T @ gradient - np.eye(2)) / 2
            of_faces[f], area = (e[0, 0], e[1, 1], e[0, 1]), abs(np.linalg.det(flat[1:] - flat[0])) / 2
        else:                           # down, right, up, left around the square
            edges, widths = np.roll(x, -1, 0) - x, np.linalg.norm(np.roll(flat, -1, 0) - flat, axis=1)
            stretch = ((edges ** 2).sum(1) / widths ** 2 - 1) / 2
            unit = edges / widths[:, None]
            shear = (unit[0] - unit[2]) @ (unit[1] - unit[3]) / 8
            of_faces[f], area = ((stretch[1] + stretch[3]) / 2, (stretch[0] + stretch[2]) / 2, shear), \
                widths[0] * widths[1]
        if np.isfinite(of_faces[f]).all():
            sums[face] += np.append(of_faces[f], 1) * area
    with np.errstate(invalid='ignore'):
        return of_faces, sums[:, :3] / sums[:, 3:]


def launch(text):
    return subprocess.run(['gst-launch-1.0', '-q'] + text.split(), stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=60)


def near(got, wanted, tolerance):
    """Every vertex the truth has a place for; one without must have some place."""
    known = np.isfinite(wanted)
    return np.isfinite(got).all() and np.abs(got[known] - wanted[known]).max() <= tolerance


# ---- glTF 2.0 (Khronos specification, 3.6.2 accessors, 3.7.2.2 morph targets, 4 GLB)

def read_glb(path):
    data = open(path, 'rb').read()
    magic, version, length = struct.unpack_from('<III', data)
    expect((magic, version, length) == (0x46546C67, 2, len(data)), 'GLB header')
    at, chunks = 12, []
    while at < len(data):
        size, kind = struct.unpack_from('<II', data, at)
        expect(size % 4 == 0, 'GLB chunk aligned')
        chunks.append((kind, data[at + 8:at + 8 + size]))
        at += 8 + size
    expect([kind for kind, _ in chunks] == [0x4E4F534A, 0x004E4942], 'GLB chunks JSON, BIN')
    return json.loads(chunks[0][1].decode()), chunks[1][1]


def accessor(tree, binary, index):
    a = tree['accessors'][index]
    width = {'SCALAR': 1, 'VEC2': 2, 'VEC3': 3}[a['type']]
    kind = np.dtype({5126: '<f4', 5125: '<u4'}[a['componentType']])
    view = tree['bufferViews'][a['bufferView']]
    stride = view.get('byteStride', width * kind.itemsize)
    start = a.get('byteOffset', 0)
    assert start + stride * (a['count'] - 1) + width * kind.itemsize <= view['byteLength']
    assert (view.get('byteOffset', 0) + start) % 4 == 0
    start += view.get('byteOffset', 0)
    rows = [np.frombuffer(binary, kind, width, start + i * stride) for i in range(a['count'])]
    values = np.array(rows)
    for name, bound in (('min', values.min(0)), ('max', values.max(0))):
        if name in a:
            assert np.array_equal(np.array(a[name], 'f4'), bound), (index, name)
    return values


def normals(places, faces):
    """Of the vertices: the mean of their triangles by area."""
    sums = np.zeros((N, 3))
    for face in faces:
        for triangle in ([face] if len(face) == 3 else [face[:3], [face[0], face[2], face[3]]]):
            a, b, c = places[triangle].astype('f8')
            sums[face] += np.cross(b - a, c - a)
    return sums / np.linalg.norm(sums, axis=1)[:, None]


def check_gltf(path, truth):
    tree, binary = read_glb(path)
    expect(tree['asset']['version'] == '2.0', 'glTF 2.0')
    expect(tree['buffers'] == [{'byteLength': len(binary)}], 'glTF buffer is the chunk')
    node = tree['nodes'][tree['scenes'][tree['scene']]['nodes'][0]]
    mesh = tree['meshes'][node['mesh']]
    primitive, = mesh['primitives']
    base_normals = accessor(tree, binary, primitive['attributes']['NORMAL'])
    bends = np.array([accessor(tree, binary, t['NORMAL']) for t in primitive['targets']])
    for index in [primitive['attributes']['POSITION']] + [
            t['POSITION'] for t in primitive['targets']]:
        assert {'min', 'max'} <= set(tree['accessors'][index])
    base = accessor(tree, binary, primitive['attributes']['POSITION'])
    targets = np.array([accessor(tree, binary, t['POSITION']) for t in primitive['targets']])
    expect(np.array_equal(accessor(tree, binary, primitive['attributes']['TEXCOORD_0']),
                          truth['uv']), 'glTF uv')
    sampler = tree['animations'][0]['samplers'][0]
    channel, = tree['animations'][0]['channels']
    expect(channel['target'] == {'node': 0, 'path': 'weights'} and
           sampler['interpolation'] == 'LINEAR', 'glTF animates weights')
    times = accessor(tree, binary, sampler['input'])[:, 0]
    weights = accessor(tree, binary, sampler['output']).reshape(len(times), len(targets))
    expect(np.allclose(times, truth['times'], atol=1e-6), 'glTF times')

    def pose(time):
        row = np.array([np.interp(time, times, w) for w in weights.T])
        return base + np.tensordot(row, targets, 1)
    for f, time in enumerate(times):
        expect(near(pose(time), truth['held'][f], 3e-7), 'glTF frame %d' % f)
        weight = np.array([np.interp(time, times, weights[:, k]) for k in range(len(bends))])
        expect(np.allclose(base_normals + np.tensordot(weight, bends, 1), normals(pose(time), truth['faces']),
                           atol=2e-4), 'glTF normals %d' % f)
    expect(near(pose((times[5] + times[6]) / 2), (truth['held'][5] + truth['held'][6]) / 2, 1e-6),
           'glTF between frames 5 and 6')
    triangles = accessor(tree, binary, primitive['indices']).reshape(-1, 3)
    wanted = [[f[0], f[k - 1], f[k]] for f in truth['faces'] for k in range(2, len(f))]
    expect(triangles.tolist() == wanted, 'glTF triangles, wound as the faces')
    # the world's z must point along glTF's y
    x, y, z, w = node['rotation']
    turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    expect(np.allclose(turn @ [0, 0, 1], [0, 1, 0]) and np.allclose(turn @ [1, 0, 0], [1, 0, 0]),
           'glTF y is up')


# ---- USD text (OpenUSD, usda file format; UsdGeomMesh)

def numbers(text):
    return np.array([float(t) for t in re.findall(r'-?\d[\d.e+-]*', text)])


def check_usd(path, truth):
    text = open(path, encoding='utf-8').read()
    expect(text.startswith('#usda 1.0\n'), 'USD cookie')
    stage = dict(re.findall(r'^    (\w+) = (\S+)', text.split('\ndef')[0], re.M))
    expect((stage['upAxis'], float(stage['metersPerUnit'])) == ('"Z"', 1), 'USD metres, z up')
    expect([float(stage[k]) for k in ('timeCodesPerSecond', 'framesPerSecond', 'startTimeCode',
                                      'endTimeCode')] == [FPS, FPS, 0, FRAMES], 'USD times')
    prim = re.search(r'^def Mesh "([A-Za-z_]\w*)"$', text, re.M).group(1)
    expect(stage['defaultPrim'] == '"%s"' % prim, 'USD default prim')
    expect(text.count('{') == text.count('}') and text.count('[') == text.count(']'),
           'USD brackets')

    def attribute(name):
        return re.search(r'^    %s = \[(.*)\]' % re.escape(name), text, re.M).group(1)

    def samples(name):
        body = re.search(r'^    %s\.timeSamples = \{\n(.*?)^    \}' % re.escape(name), text,
                         re.M | re.S).group(1)
        rows = re.findall(r'^ +([\d.]+): \[(.*)\],$', body, re.M)
        return [float(c) for c, _ in rows], np.array([numbers(v).reshape(-1, 3) for _, v in rows])
    expect('subdivisionScheme = "none"' in text, 'USD polygons, no subdivision')
    counts = numbers(attribute('int[] faceVertexCounts')).astype(int)
    indices = numbers(attribute('int[] faceVertexIndices')).astype(int)
    expect([list(f) for f in np.split(indices, np.cumsum(counts)[:-1])] == truth['faces'],
           'USD faces')
    st = numbers(attribute('texCoord2f[] primvars:st')).reshape(-1, 2)
    expect(np.array_equal(st.astype('f4'), truth['uv']), 'USD st')
    codes, points = samples('point3f[] points')
    expect(codes == [round(t * FPS) for t in truth['times']], 'USD time codes, with the gap')
    expect(near(points.astype('f4'), truth['held'], 0), 'USD points')
    again, extent = samples('float3[] extent')
    expect(again == codes and np.array_equal(
        extent, np.stack([points.min(1), points.max(1)], 1)), 'USD extents')


# ---- VTK XML (VTK file formats, "XML file formats"; ParaView's PVD)

def check_vtp(path, truth):
    folder = os.path.dirname(path)
    sets = xml.etree.ElementTree.parse(path).getroot().findall('Collection/DataSet')
    expect(len(sets) == FRAMES and
           np.allclose([float(s.get('timestep')) for s in sets], truth['times']), 'PVD times')
    for f, item in enumerate(sets):
        data = open(os.path.join(folder, item.get('file')), 'rb').read()
        head, rest = data.split(b'<AppendedData encoding="raw">\n_', 1)
        root = xml.etree.ElementTree.fromstring(head + b'</VTKFile>')
        assert root.get('header_type') == 'UInt64' and root.get('byte_order') == 'LittleEndian'
        piece = root.find('PolyData/Piece')
        arrays, cells = {}, {}
        for part in piece:
            for a in part:
                at = int(a.get('offset'))
                size, = struct.unpack_from('<Q', rest, at)
                kind = {'UInt8': 'u1', 'Float32': '<f4', 'Int32': '<i4'}[a.get('type')]
                values = np.frombuffer(rest[at + 8:at + 8 + size], kind)
                width = int(a.get('NumberOfComponents'))
                into = cells if part.tag == 'CellData' else arrays
                into[a.get('Name')] = values.reshape(-1, width) if width > 1 else values
                if a.get('Name') == 'strain':
                    assert [a.get('ComponentName%d' % k) for k in range(3)] == ['warp', 'weft', 'shear']
                end = at + 8 + size
        assert rest[end:] == b'\n</AppendedData>\n</VTKFile>\n'
        assert (int(piece.get('NumberOfPoints')), int(piece.get('NumberOfPolys'))) == (
            N, len(truth['faces']))
        faces = np.split(arrays['connectivity'], arrays['offsets'][:-1])
        expect([list(face) for face in faces] == truth['faces'] and
               arrays['offsets'][-1] == len(arrays['connectivity']), 'VTP faces %d' % f)
        expect(near(arrays['Points'], truth['held'][f], 0) and
               np.array_equal(arrays['uv'], truth['uv']) and
               np.array_equal(arrays['state'], truth['states'][f]) and
               np.allclose(arrays['sigma'], truth['sigma'][f], rtol=1e-5, equal_nan=True),
               'VTP frame %d' % f)
        expect(same_strain(arrays['strain'], truth['strain'][f]) and
               same_strain(cells['strain'], truth['face_strain'][f]), 'VTP strain %d' % f)


def same_strain(got, wanted):
    return got.shape == wanted.shape and np.allclose(got, wanted, atol=2e-6, equal_nan=True)


# ---- PLY (Turk, The PLY Polygon File Format)

def check_ply(stem, truth):
    kinds = {'float': '<f4', 'uchar': 'u1', 'uint': '<u4'}
    for f in range(FRAMES):
        data = open('%s_%05d.ply' % (stem, f), 'rb').read()
        head, body = data.split(b'end_header\n', 1)
        elements = []
        for words in (line.split() for line in head.decode().splitlines()):
            if words[0] == 'element':
                elements.append((words[1], int(words[2]), []))
            elif words[0] == 'property':
                elements[-1][2].append(words[1:])
        (vertex, n, properties), (face, n_faces, others) = elements
        assert (vertex, n, face, n_faces) == ('vertex', N, 'face', len(truth['faces']))
        kind = np.dtype([(name, kinds[word]) for word, name in properties])
        rows = np.frombuffer(body, kind, N)
        assert others == [['list', 'uchar', 'uint', 'vertex_indices']]
        faces, at = [], N * kind.itemsize
        for _ in range(n_faces):
            size = body[at]
            faces.append(list(np.frombuffer(body, '<u4', size, at + 1)))
            at += 1 + 4 * size
        names = ['strain_warp', 'strain_weft', 'strain_shear']
        expect(at == len(body) and faces == truth['faces'] and
               near(np.stack([rows[c] for c in 'xyz'], 1), truth['held'][f], 0) and
               np.array_equal(rows['state'], truth['states'][f]), 'PLY frame %d' % f)
        expect(same_strain(np.stack([rows[c] for c in names], 1), truth['strain'][f]),
               'PLY strain %d' % f)


# ---- C3D (The C3D File Format User Guide)

def read_c3d(path):
    data = open(path, 'rb').read()
    assert len(data) % 512 == 0 and data[1] == 0x50
    n, analog, first, last, _, scale, start, _, rate = struct.unpack_from('<HHHHHfHHf', data, 2)
    at = (data[0] - 1) * 512
    blocks, processor = data[at + 2], data[at + 3]
    assert processor == 84
    expect(start == data[0] + blocks and analog == 0, 'C3D data stand behind the parameters')
    at += 4
    groups, found = {}, {}
    while data[at]:
        length, group = struct.unpack_from('<bb', data, at)
        name = data[at + 2:at + 2 + abs(length)].decode('ascii')
        next_at = at + 2 + abs(length)
        offset, = struct.unpack_from('<H', data, next_at)
        if group < 0:
            groups[-group] = name
        else:
            kind, rank = struct.unpack_from('<bB', data, next_at + 2)
            shape = list(data[next_at + 4:next_at + 4 + rank])
            count = int(np.prod(shape)) if shape else 1
            raw = data[next_at + 4 + rank:next_at + 4 + rank + count * abs(kind)]
            assert next_at + offset == next_at + 4 + rank + len(raw) + 1
            if kind == -1:
                width = shape[0]
                value = [raw[i:i + width].decode('ascii').rstrip()
                         for i in range(0, len(raw), width)]
            else:
                value = np.frombuffer(raw, {1: 'u1', 2: '<u2', 4: '<f4'}[kind])
            found[groups[group] + ':' + name] = value
        at = next_at + offset
    expect(at < (start - 1) * 512, 'C3D parameters end in their blocks')
    expect(found['POINT:USED'][0] == n and found['POINT:DATA_START'][0] == start and
           found['POINT:SCALE'][0] == scale and found['POINT:RATE'][0] == rate,
           'C3D header and parameters agree')
    frames = last - first + 1
    expect(found['POINT:FRAMES'][0] == frames and
           list(found['TRIAL:ACTUAL_START_FIELD']) == [first, 0] and
           list(found['TRIAL:ACTUAL_END_FIELD']) == [last, 0], 'C3D number of frames')
    values = np.frombuffer(data, '<f4', frames * n * 4, (start - 1) * 512).reshape(frames, n, 4)
    labels, part = list(found['POINT:LABELS']), 2
    while 'POINT:LABELS%d' % part in found:
        labels += found['POINT:LABELS%d' % part]
        part += 1
    return values, labels, scale, rate, found


def check_c3d(path, truth):
    values, labels, scale, rate, found = read_c3d(path)
    expect(rate == FPS and scale < 0 and found['POINT:UNITS'] == ['mm'], 'C3D rate, floats, mm')
    expect(labels == ['v%03d' % i for i in range(N)], 'C3D labels, beyond 255')
    unseen = truth['states'] == 0
    expect(np.array_equal(values[..., 3] == -1, unseen) and not values[unseen][:, :3].any(),
           'C3D unseen markers')
    expect(np.allclose(values[~unseen][:, :3], 1000 * truth['positions'][~unseen].astype('f8'),
                       rtol=1e-7, atol=1e-4), 'C3D places')
    words = values[..., 3].astype('i2')
    cameras = np.array([[bin(w >> 8).count('1') for w in row] for row in words])
    expect(np.array_equal(cameras[~unseen], np.array([0, 3, 2, 0, 0])[truth['states'][~unseen]]),
           'C3D cameras of a marker')
    measured = np.isin(truth['states'], (1, 2))
    known = measured & np.isfinite(truth['sigma'])
    residual = (words & 255) * -scale
    expect(np.allclose(residual[known], 1000 * truth['sigma'][known], atol=0.51 * -scale),
           'C3D residuals')
    expect(not residual[~unseen & ~known].any(), 'C3D no residual where not measured')


# ---- CSV (RFC 4180, docs/formats.md)

def check_csv(path, truth):
    rows = list(csv.DictReader(open(path, encoding='ascii')))
    expect(list(rows[0]) == ['frame', 'time_s', 'vertex', 'x_m', 'y_m', 'z_m', 'sigma_m', 'state',
                             'strain_warp', 'strain_weft', 'strain_shear'],
           'CSV columns')

    def column(name):
        return np.array([float(r[name] or 'nan') for r in rows]).reshape(FRAMES, N)
    places = np.stack([column(c) for c in ('x_m', 'y_m', 'z_m')], -1).astype('f4')
    expect(np.array_equal(places, truth['positions'], equal_nan=True), 'CSV places')
    expect(np.allclose(column('sigma_m'), truth['sigma'], rtol=1e-5, equal_nan=True), 'CSV sigma')
    expect(same_strain(np.stack([column('strain_' + c) for c in ('warp', 'weft', 'shear')], -1),
                       truth['strain']), 'CSV strain')
    expect(np.array_equal(column('state'), truth['states']) and
           np.allclose(column('time_s'), truth['times'][:, None]) and
           (column('vertex') == np.arange(N)).all() and
           (column('frame') == np.arange(FRAMES)[:, None]).all(), 'CSV keys')


FORMATS = {'glb': check_gltf, 'usda': check_usd, 'pvd': check_vtp, 'c3d': check_c3d,
           'csv': check_csv}


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        truth = make_take('sheet.take')
        for ending, check in FORMATS.items():
            for name in ('one', 'two'):
                os.makedirs(name, exist_ok=True)
                done = launch('meshsrc location=sheet.take ! meshsink location=%s/sheet.%s mesh-name=1<é>' %
                              (name, ending))
                expect(done.returncode == 0 and not done.stdout, '%s written %s' %
                       (ending, done.stdout))
            check('one/sheet.' + ending, truth)
            # what is written can't be read, and that is said
            back = launch('meshsrc location=one/sheet.%s ! fakesink' % ending)
            expect(back.returncode != 0 and 'written, not read' in back.stdout,
                   '%s is refused by meshsrc' % ending)
        launch('meshsrc location=sheet.take ! meshsink location=sheet.ply')
        check_ply('sheet', truth)
        one, two = (sorted(os.listdir(d)) for d in ('one', 'two'))
        expect(one == two and len(one) == 5 + FRAMES, 'files: %s' % one)
        expect(all(open('one/' + f, 'rb').read() == open('two/' + f, 'rb').read() for f in one),
               'the same bytes again')
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
