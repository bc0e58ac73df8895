"""Makes recordings of a small cloth: simulated otherwise than the diagnosis does, noisy,
in part unseen.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import copy
import json
import os
import subprocess

import numpy

from cases import FAMILIES

COLUMNS, ROWS = 9, 10
WIDTH, HEIGHT = 0.22, 0.24
FPS = 50.
# Before the recording begins the clamps close and the cloth comes to hang.
N_BEFORE, N_FRAMES = 25, 75
HELD = (0, COLUMNS - 1)
MODEL = {
    'version': 1, 'force_model': 'membrane', 'areal_density': 0.15,
    'stretch': {'warp': 40., 'weft': 40.}, 'shear': 12.,
    'bending': {'warp': 3e-5, 'weft': 3e-5}, 'damping': {'mass': 0.3, 'stiffness': 5e-4},
}


def diagnosed_model():
    """What is known of the cloth: about right, and free to be fitted."""
    model = copy.deepcopy(MODEL)
    model['free'] = []
    for name in ('stretch.warp', 'stretch.weft', 'shear', 'bending.warp', 'bending.weft',
                 'damping.mass', 'damping.stiffness'):
        value = model
        for key in name.split('.'):
            value = value[key]
        model['free'].append({'name': name, 'range': [value / 30., value * 30.]})
    return model


def real_model(family, random):
    """What really hangs there: other numbers, another simulator."""
    model = dict(copy.deepcopy(MODEL), **copy.deepcopy(FAMILIES[family]))
    for key, value in MODEL.items():
        scale = numpy.exp(0.15 * random.normal(size=2))
        if key in ('stretch', 'bending'):
            model[key] = {'warp': value['warp'] * scale[0], 'weft': value['weft'] * scale[1]}
        elif key == 'shear':
            model[key] = value * scale[0]
        elif key == 'damping':
            model[key] = {'mass': value['mass'] * scale[0],
                          'stiffness': value['stiffness'] * scale[1]}
    return model


def choose_motion(random):
    """How the clamps go: they close, then sway; amplitudes, frequencies and phases."""
    return {'close': random.uniform(0.03, 0.05), 'across': random.uniform(0.03, 0.05, 2),
            'along': random.uniform(0.005, 0.02), 'up': random.uniform(0.005, 0.02),
            'hz': random.uniform(0.9, 1.7, 3), 'phase': random.uniform(0, 6.28, 3)}


def clamps_of(motion, random):
    """Paths of the clamps; each time the same motion is repeated it is so to 0.3 mm."""
    t = (numpy.arange(N_BEFORE + N_FRAMES) - N_BEFORE) / FPS
    ramp = numpy.clip((t + N_BEFORE / FPS) / 0.4, 0., 1.)
    ramp = ramp ** 2 * (3. - 2. * ramp)
    wave = [numpy.sin(6.2832 * hz * t + phase) - numpy.sin(phase)
            for hz, phase in zip(motion['hz'], motion['phase'])]
    paths = numpy.zeros((len(t), 2, 3))
    for held in range(2):
        paths[:, held, 0] = held * WIDTH + ramp * (
            (0.5 - held) * motion['close'] + motion['along'] * wave[1])
        paths[:, held, 1] = ramp * motion['across'][held] * wave[0]
        paths[:, held, 2] = ramp * motion['up'] * wave[2]
        for axis in range(3):
            paths[:, held, axis] += ramp * 2e-4 * random.normal() * numpy.sin(
                6.2832 * random.uniform(0.5, 2.) * t)
    return paths


def effects_in_take(effects):
    """Effects as a model has them that starts when the recording does, not before."""
    effects = copy.deepcopy(effects)
    if 'clamp_slip' in effects:
        effects['clamp_slip']['time'] -= N_BEFORE / FPS
    return effects


def write_take(folder, name, positions, clamps, noise=None, held=HELD, obstacles=(), from_s=None):
    os.makedirs(folder)
    take = {'version': 1, 'name': name, 'fps': FPS,
            'grid': {'columns': COLUMNS, 'rows': ROWS, 'width_m': WIDTH, 'height_m': HEIGHT},
            'held': [dict({'vertex': vertex}, **({} if from_s is None or vertex in HELD else
                                                 {'from_s': from_s})) for vertex in held],
            'obstacles': list(obstacles)}
    if noise is not None:
        take['noise_sigma_m'] = noise
    with open(os.path.join(folder, 'take.json'), 'w', encoding='utf-8') as file:
        json.dump(take, file)
    numpy.save(os.path.join(folder, 'positions.npy'), positions.astype('float32'))
    numpy.save(os.path.join(folder, 'clamps.npy'), clamps.astype('float32'))


def simulate(tool, model, clamps, scratch, held=HELD, obstacles=(), from_s=None, bulge_m=0.):
    """What the cloth does, from half a second before the recording on; what is held besides
    the corners is so from a time on; its lower edge may bulge at first."""
    start = numpy.full((len(clamps), ROWS * COLUMNS, 3), numpy.nan)
    v, u = numpy.divmod(numpy.arange(ROWS * COLUMNS), COLUMNS)
    start[0, :, 0] = u * WIDTH / (COLUMNS - 1)
    start[0, :, 1] = bulge_m * numpy.sin(numpy.pi * u / (COLUMNS - 1)) * v / (ROWS - 1)
    start[0, :, 2] = -v * HEIGHT / (ROWS - 1)
    write_take(os.path.join(scratch, 'scene'), 'scene', start, clamps, None, held, obstacles,
               from_s)
    with open(os.path.join(scratch, 'model.json'), 'w', encoding='utf-8') as file:
        json.dump(model, file)
    done = subprocess.run([tool, 'simulate', os.path.join(scratch, 'model.json'), '--scene',
                           os.path.join(scratch, 'scene'), '--output',
                           os.path.join(scratch, 'made'), '--threads', '1'],
                          capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr.strip().split('\n')[-1])
    positions = numpy.load(os.path.join(scratch, 'made/positions.npy')).astype(float)
    for name in ('scene', 'made'):
        for file in os.listdir(os.path.join(scratch, name)):
            os.remove(os.path.join(scratch, name, file))
        os.rmdir(os.path.join(scratch, name))
    return positions


def shape_outside(name, size, positions, clamps):
    """What no effect of the library is, of what is done to the positions alone."""
    t = (numpy.arange(len(positions)) - N_BEFORE) / FPS
    if name == 'drift':
        # The calibration drifts: the lower and the right part bulge towards the camera.
        middle = positions - clamps[:, :1]
        bulge = (middle[:, :, 2] / HEIGHT) ** 2 * (middle[:, :, 0] / WIDTH)
        positions = positions.copy()
        positions[:, :, 1] += 1.5e-3 * size * numpy.clip(t, 0., None)[:, None] * bulge
    elif name == 'wobble':
        # The recorder's clock wobbles.
        at = numpy.clip(t + 2e-3 * size * numpy.sin(6.2832 * 1.3 * t), t[0], t[-1])
        flat = positions.reshape(len(t), -1)
        positions = numpy.stack([numpy.interp(at, t, column) for column in flat.T],
                                axis=1).reshape(positions.shape)
    return positions


def simulate_outside(tool, model, clamps, outside, size, scratch):
    """Reality with something in it that the library has no name for."""
    t = (numpy.arange(len(clamps)) - N_BEFORE) / FPS
    on = numpy.clip(t / 0.1, 0., 1.)
    if outside == 'clamp-shake':
        # A clamp trembles, and the log doesn't know.
        real = clamps.copy()
        real[:, 1, 2] += 1.5e-3 * size * on * numpy.sin(6.2832 * 4. * t)
        return simulate(tool, model, real, scratch)
    if outside == 'shaken-frame':
        # Clamps, cloth and cameras ride on a platform: a periodic force on all.
        ride = 1.5e-3 * size * on * numpy.sin(6.2832 * 3. * t)
        real = clamps.copy()
        real[:, :, 1] += ride[:, None]
        positions = simulate(tool, model, real, scratch)
        positions[:, :, 1] -= ride[:, None]
        return positions
    if outside == 'obstacle':
        # A ball that the cloth swings against.
        ball = {'type': 'sphere', 'centre': [WIDTH / 2, 0.05, -0.75 * HEIGHT],
                'radius_m': 0.03 + 0.003 * size}
        return simulate(tool, model, clamps, scratch, obstacles=[ball])
    if outside == 'caught':
        # The lower corner hangs on a thread that gives slowly.
        free = simulate(tool, model, clamps, scratch)
        corner = ROWS * COLUMNS - 1
        path = free[:, corner].copy()
        slow = path[N_BEFORE] + (path - path[N_BEFORE]) * (1. - 0.1 * size)
        path = numpy.where(t[:, None] > 0., slow, path)
        caught = numpy.concatenate([clamps, path[:, None]], axis=1)
        return simulate(tool, model, caught, scratch, held=HELD + (corner,))
    return shape_outside(outside, size, simulate(tool, model, clamps, scratch), clamps)


def touch_with_ball(tool, model, clamps, free, size, scratch, random):
    """A ball in the way of a vertex, where it comes first at a time by chance."""
    radius = 0.04 + 0.002 * size
    for _ in range(200):
        first = N_BEFORE + int(random.integers(20, 50))
        vertex = int(random.integers(3 * COLUMNS, ROWS * COLUMNS))
        way = free[first + 1, vertex] - free[first - 1, vertex]
        speed = numpy.linalg.norm(way) * FPS / 2.
        centre = free[first, vertex] + way / max(numpy.linalg.norm(way), 1e-9) * radius
        apart = numpy.linalg.norm(free - centre, axis=2)
        if speed > 0.1 and apart[:first].min() > radius + 1e-3:
            ball = {'type': 'sphere', 'centre': centre.tolist(), 'radius_m': radius}
            real = simulate(tool, model, clamps, scratch, obstacles=[ball])
            apart = numpy.linalg.norm(real[N_BEFORE:] - centre, axis=2).min(axis=0)
            return real, numpy.flatnonzero(apart < radius + 2e-3)
    raise RuntimeError('the cloth is too slow to touch a ball')


def lead_with_finger(tool, model, clamps, free, size, scratch, random):
    """A patch that is taken hold of, and led off the way it would go."""
    first = N_BEFORE + int(random.integers(20, 50))
    rows, columns = random.integers(2, 5, 2)
    row, column = random.integers(2, ROWS - rows + 1), random.integers(0, COLUMNS - columns + 1)
    patch = ((row + numpy.arange(rows))[:, None] * COLUMNS + column +
             numpy.arange(columns)).ravel()
    way = random.normal(size=3) * (0.3, 1., 0.3)
    on = numpy.clip((numpy.arange(len(clamps)) - first) / (0.2 * FPS), 0., 1.)
    on = on ** 2 * (3. - 2. * on)
    path = free[:, patch] + 0.003 * size * on[:, None, None] * way / numpy.linalg.norm(way)
    real = simulate(tool, model, numpy.concatenate([clamps, path], axis=1), scratch,
                    held=HELD + tuple(int(vertex) for vertex in patch), from_s=first / FPS)
    return real, patch


def act_locally(tool, model, clamps, case, free, scratch, random):
    """The cloth with a local case, and where its force acts (None: no place of its own)."""
    if case['outside'] == 'ball':
        return touch_with_ball(tool, model, clamps, free, case['severity'], scratch, random)
    if case['outside'] == 'finger':
        return lead_with_finger(tool, model, clamps, free, case['severity'], scratch, random)
    real = simulate(tool, model, clamps, scratch)
    if case['outside'] == 'slip':
        return real, None
    # Vertices that stand for more of the hem than of what is above it.
    height = case['effects']['mass_distribution']['height']
    row = numpy.arange(ROWS * COLUMNS) // COLUMNS
    return real, numpy.flatnonzero((ROWS - 1.5 - row) * HEIGHT / (ROWS - 1) < height)


def film(folder, name, positions, clamps, random):
    """Noise and what is hidden; the stated noise is what a rig would state."""
    noise = random.uniform(3e-4, 5e-4)
    seen = positions[N_BEFORE:] + noise * random.normal(size=positions[N_BEFORE:].shape)
    row, column = numpy.divmod(numpy.arange(ROWS * COLUMNS), COLUMNS)
    for _ in range(3):
        # Something passes before the cloth.
        first = random.integers(0, N_FRAMES - 12)
        at = random.uniform(0, (ROWS, COLUMNS))
        way = random.normal(size=2) * 0.2
        for frame in range(first, first + random.integers(6, 12)):
            y, x = at + way * (frame - first)
            seen[frame, (row - y) ** 2 + (column - x) ** 2 < 2.5] = numpy.nan
    lost = random.random(seen.shape[:2]) < 0.01
    seen[lost] = numpy.nan
    write_take(folder, name, seen, clamps[N_BEFORE:], noise)
    return noise


def record(tool, case, folder, name, scratch, random):
    """Records a case and its baseline; returns what the label needs beyond the case."""
    plain = real_model(case['family'], random)
    model = copy.deepcopy(plain)
    model['effects'].update(copy.deepcopy(case['effects']))
    # Effects count from when the simulation starts, half a second before the recording.
    motion = choose_motion(random)
    clamps = clamps_of(motion, random)
    quiet = simulate(tool, plain, clamps, scratch)
    region = None
    if case['kind'] == 'local':
        real, region = act_locally(tool, model, clamps, case, quiet, scratch, random)
    elif case['outside']:
        real = simulate_outside(tool, model, clamps, case['outside'], case['severity'], scratch)
    elif case['effects']:
        real = simulate(tool, model, clamps, scratch)
    elif case.get('bulge_m'):
        real = simulate(tool, plain, clamps, scratch, bulge_m=case['bulge_m'])
    else:
        real = quiet
    noise = film(os.path.join(folder, 'take'), name, real, clamps, random)
    other = motion if case['baseline'] == 'same' else choose_motion(random)
    clamps = clamps_of(other, random)
    film(os.path.join(folder, 'baseline'), name + '-baseline',
         simulate(tool, plain, clamps, scratch), clamps, random)
    change = (real - quiet)[N_BEFORE:]
    # What begins later leaves the cloth as it was until then, to the last bit but one.
    moved = numpy.flatnonzero(numpy.abs(change).max(axis=(1, 2)) > 1e-5)
    return {'size_m': float(numpy.sqrt((change ** 2).sum(axis=2).mean())), 'noise_m': noise,
            'region': None if region is None else [int(vertex) for vertex in region],
            'onset_s': float(moved[0] / FPS) if len(moved) and moved[0] else None}
