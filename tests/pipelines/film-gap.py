#!/usr/bin/python3
"""Films a simulated cloth with three cameras, one of which may not be what the rig says;
makes takes with observations of the films, in one pipeline each, and has them diagnosed.

  film-gap.py TOOL GAPBENCH

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile

import numpy

tool, gapbench = (os.path.abspath(path) for path in sys.argv[1:])
sys.path.insert(0, gapbench)
import families  # pylint: disable=wrong-import-position,import-error
import reality  # pylint: disable=wrong-import-position,import-error

CLOTH = reality.CLOTH
COLUMNS, ROWS, WIDTH = CLOTH['columns'], CLOTH['rows'], CLOTH['width_m']
SQUARE = WIDTH / (COLUMNS - 1)
# Squares are square; the sheet of the benchmark is not quite made of them.
HEIGHT = CLOTH['height_m'] = SQUARE * (ROWS - 1)
FPS, N_FRAMES = 50., 50
# Faces between two vertices, so that the filmed cloth is smooth; the print has a margin.
FINE = 3
CAMERAS = ('left', 'middle', 'right')
# The film's own blur and noise, in every camera.
PICTURE = 'defocus,sigma=0.6; noise,sigma=2,shot=2'
# What acts, in which camera; and the number that says how strongly.
CASES = {
    'good': None,
    'late': ('sync_offset', 'middle', 'seconds', 0.015),
    'turned': ('extrinsic_drift', 'right', 'tilt', 0.002),
}
# All of them are considered of the good take; of the others these, to save time.
CONSIDERED = ('sync_offset,extrinsic_drift,focal_length,lens_distortion,rolling_shutter,'
              'frame_drop,motion_blur,clamp_delay,gravity_tilt')
faults = []


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what), flush=True)
    if not true:
        faults.append(what)


def save(path, value):
    with open(path, 'w', encoding='utf-8') as file:
        json.dump(value, file)


def make_rig():
    """Cameras at 0.95 m around the cloth's middle, one of them low, one high."""
    middle = numpy.array([WIDTH / 2, 0, -HEIGHT / 2])
    cameras = []
    for name, around, up in zip(CAMERAS, (-28, 2, 27), (8, -12, 14)):
        a, b = numpy.radians([around, up])
        ahead = numpy.array([-numpy.sin(a) * numpy.cos(b), numpy.cos(a) * numpy.cos(b),
                             -numpy.sin(b)])
        right = numpy.cross(ahead, [0, 0, 1])
        right /= numpy.linalg.norm(right)
        turn = numpy.stack([right, numpy.cross(ahead, right), ahead])
        cameras.append({
            'name': name, 'size': [480, 360], 'K': [[810, 0, 239.5], [0, 810, 179.5], [0, 0, 1]],
            'distortion': {'model': 'brown5', 'coefficients': [-0.08, 0.02, 0, 0, 0]},
            'R': turn.tolist(), 't': (-turn @ (middle - 0.95 * ahead)).tolist()})
    return {'version': 1, 'cameras': cameras}


def spline(count):
    """Weights of a Catmull-Rom spline through so many knots, from one square before the
    first to one behind the last; beyond the knots it goes on straight."""
    knots = numpy.zeros((count + 4, count))
    knots[2:-2] = numpy.eye(count)
    for k in (1, 0):
        knots[k] = 2 * knots[k + 1] - knots[k + 2]
        knots[-1 - k] = 2 * knots[-2 - k] - knots[-3 - k]
    weights = []
    for i in range((count + 1) * FINE + 1):
        k, f = min(i // FINE, count), i / FINE - min(i // FINE, count)
        four = numpy.array([-f + 2 * f**2 - f**3, 2 - 5 * f**2 + 3 * f**3,
                            f + 4 * f**2 - 3 * f**3, -f**2 + f**3]) / 2
        rows = knots[k:k + 4]
        weights.append(four[:len(rows)] @ rows)
    return numpy.array(weights)


def write_cloth(folder, positions):
    """What is filmed: the simulated cloth, finer, with a margin around the print."""
    fine = numpy.einsum('ar,bc,frcx->fabx', spline(ROWS), spline(COLUMNS),
                        positions.reshape(-1, ROWS, COLUMNS, 3))
    inside = fine[:, FINE:-FINE:FINE, FINE:-FINE:FINE].reshape(positions.shape)
    assert abs(inside - positions).max() < 1e-12
    os.mkdir(folder)
    save(folder + '/take.json', {
        'version': 1, 'name': 'cloth', 'fps': FPS,
        'grid': {'columns': fine.shape[2], 'rows': fine.shape[1],
                 'width_m': SQUARE * (COLUMNS + 1), 'height_m': SQUARE * (ROWS + 1)}})
    numpy.save(folder + '/positions.npy',
               fine.reshape(len(fine), -1, 3).astype('float32'))


def film(cloth, take, clamps, seed, case):
    """A pipeline makes the take; the clamps' log and what was known is put beside it."""
    os.makedirs(take + '/observations')
    shutil.copyfile('rig.json', take + '/rig.json')
    # Three branches of one film wait for each other: none may be full before the others.
    wide = ['queue', 'max-size-buffers=0', 'max-size-bytes=0', 'max-size-time=0']
    command = ['gst-launch-1.0', '-q', 'triangulate', 'name=join', 'rig=rig.json',
               'pattern=pattern.json', '!', 'meshsink', 'format=take', 'location=' + take,
               'meshsrc', 'location=' + cloth, '!', 'tee', 'name=cloth']
    for i, camera in enumerate(CAMERAS):
        effects = PICTURE
        if case and case[1] == camera:
            effects += '; %s,%s=%g' % (case[0], case[2], case[3])
        command += ['cloth.', '!', *wide, '!', 'clothcamera', 'rig=rig.json', 'camera=' + camera,
                    'pattern=pattern.json', 'effects=' + effects, 'seed=%d' % (10 * seed + i), '!',
                    'video/x-raw,format=GRAY8', '!', 'saddledetect', '!', 'quadtrack',
                    'pattern=pattern.json', 'camera=' + camera, '!', 'tee', 'name=' + camera,
                    camera + '.', '!', *wide, '!', 'join.', camera + '.', '!', 'queue', '!',
                    'clothmetapay', '!', 'filesink',
                    'location=%s/observations/%s.obs' % (take, camera)]
    subprocess.run(command, check=True, stdin=subprocess.DEVNULL, timeout=600)
    if os.path.exists(take + '/mesh.obj'):
        os.remove(take + '/mesh.obj')
    save(take + '/take.json', {
        'version': 1, 'name': take, 'fps': FPS,
        'grid': CLOTH, 'held': [{'vertex': 0}, {'vertex': COLUMNS - 1}]})
    numpy.save(take + '/clamps.npy', clamps.astype('float32'))


def read_gap(folder):
    """All of it, and the effects of cameras and pictures, the likeliest first."""
    with open(folder + '/gap.json', encoding='utf-8') as file:
        gap = json.load(file)
    effects = [effect for effect in gap['effects'] if effect['side'] in ('camera', 'image')]
    return gap, effects


def sha256(take):
    """The hash of what sha256sum prints of all files of a take."""
    names = sorted(os.path.relpath(os.path.join(at, name), take)
                   for at, _, files in os.walk(take) for name in files)
    lines = ''
    for name in names:
        with open(os.path.join(take, name), 'rb') as file:
            lines += '%s  %s\n' % (hashlib.sha256(file.read()).hexdigest(), name)
    return hashlib.sha256(lines.encode()).hexdigest()


def check(take, case):
    effects = ('--effects', CONSIDERED) if case else ()
    done = subprocess.run([tool, 'diagnose', take, '--model', 'model.json', '--baseline',
                           'baseline', '--output', take + '-gap', *effects],
                          capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=600,
                          check=False)
    expect(done.returncode == 0, '%s: %s' % (take, done.stdout.split('\n')[0] or done.stderr))
    if done.returncode:
        return
    gap, effects = read_gap(take + '-gap')
    if not effects:
        expect(False, 'no effect of a camera was looked at')
        return
    expect(gap['inputs'][0]['sha256'] == sha256(take), 'its hash is of rig and observations, too')
    if not case:
        accepted = [effect['name'] for effect in gap['effects'] if effect['accepted']]
        expect(not accepted and gap['verdict'] == 'no_gap',
               'nothing is accepted: %s' % accepted)
        return
    first = effects[0]
    value = [p for p in first['parameters'] if p['name'] == case[2]]
    expect((first['name'], first['camera'], first['accepted']) == (case[0], case[1], True),
           '%s of %s comes first, accepted' % (first['name'], first['camera']))
    expect(value and abs(value[0]['value'] - case[3]) < 0.05 * case[3],
           '%s: %s, truly %g' % (case[2], value and value[0]['value'], case[3]))


def check_element(take):
    """clothgap reads the same from the folders that it is given."""
    subprocess.run(['gst-launch-1.0', '-q', 'meshsrc', 'location=' + take, '!', 'clothgap',
                    'model=model.json', 'location=' + take, 'baseline=baseline',
                    'output=live', 'effects=' + CONSIDERED, '!', 'fakesink'], check=True, stdin=subprocess.DEVNULL,
                   timeout=600)
    live, told = read_gap('live')[1][0], read_gap(take + '-gap')[1][0]
    expect((live['name'], live['camera']) == (told['name'], told['camera']),
           'clothgap: %s of %s' % (live['name'], live['camera']))


def main():
    save('rig.json', make_rig())
    save('pattern.json', {
        'version': 1, 'pattern': 'checker', 'columns': COLUMNS - 1, 'rows': ROWS - 1,
        'square_m': SQUARE, 'origin_uv_m': [SQUARE, SQUARE],
        'cloth_m': [SQUARE * (COLUMNS + 1), SQUARE * (ROWS + 1)], 'first_square': 'black'})
    save('model.json', reality.diagnosed_model())
    random = numpy.random.default_rng(8)
    real = families.draw_numbers(random)
    realities = families.Realities(tool, '.')
    times = reality.BEFORE + numpy.arange(N_FRAMES) / FPS
    clamps = {}
    for name in ('filmed', 'accepted'):
        setup = reality.move(reality.choose_setup({'stranger': None}, random), random)
        positions = realities.simulate('membrane-implicit-fine', setup, real)
        write_cloth(name, families.interpolate(positions, times))
        clamps[name] = families.interpolate(setup['paths'], times)
    film('accepted', 'baseline', clamps['accepted'], 9, None)
    for seed, (name, case) in enumerate(CASES.items()):
        film('filmed', name, clamps['filmed'], seed, case)
        check(name, case)
    check_element('late')


with tempfile.TemporaryDirectory(prefix='film-gap-') as scratch:
    os.chdir(scratch)
    main()
    os.chdir('/')
sys.exit(1 if faults else 0)
