"""The realities of the benchmark: the project's own simulator otherwise discretised than the
diagnosis does, and simulators that share no code with it.

All simulate the same setup, a dict:

  cloth   columns, rows, width_m, height_m of what is recorded
  held    vertices of the flat cloth in shares of its width and height; edge: whether what lies
          between the first two is held as well
  paths   [frames][held][3], where held points go, HZ times a second; until_s: {held: s}

and give positions [frames][points][3] of a grid of any number of columns and rows.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import copy
import json
import os
import subprocess
import tempfile

import numpy

from cases import EXPRESSES, OWN

# Simulated frames a second; cameras see them through a cubic.
HZ = 200.
MODEL = {
    'version': 1, 'force_model': 'membrane', 'areal_density': 0.15,
    'stretch': {'warp': 40., 'weft': 40.}, 'shear': 12.,
    'bending': {'warp': 3e-5, 'weft': 3e-5}, 'damping': {'mass': 0.3, 'stiffness': 5e-4},
}
# How many times as fine a mesh as the recording's a program computes with.
FINER = {'fem': 2, 'xpbd': 2, 'bullet': 2}


class CannotSimulate(RuntimeError):
    """What was asked for ran away, or the program isn't there."""


def draw_numbers(random, spread=0.15):
    """What really hangs there: other stiffnesses and dampings than the diagnosis is told."""
    model = copy.deepcopy(MODEL)
    for key, value in MODEL.items():
        scale = numpy.exp(spread * random.normal(size=2))
        if key in ('stretch', 'bending'):
            model[key] = {'warp': value['warp'] * scale[0], 'weft': value['weft'] * scale[1]}
        elif key == 'shear':
            model[key] = value * scale[0]
        elif key == 'damping':
            model[key] = {'mass': value['mass'] * scale[0],
                          'stiffness': value['stiffness'] * scale[1]}
    return model


def flat_points(setup, grid):
    """The flat cloth in the plane x, z, hanging down from the first row."""
    columns, rows = grid
    v, u = numpy.divmod(numpy.arange(columns * rows), columns)
    flat = numpy.zeros((columns * rows, 3))
    flat[:, 0] = u * setup['cloth']['width_m'] / (columns - 1)
    flat[:, 2] = -v * setup['cloth']['height_m'] / (rows - 1)
    return flat


def holds_of(setup, grid, paths=None):
    """Vertices of a grid that are held, their paths and until when."""
    columns, rows = grid
    paths = setup['paths'] if paths is None else paths
    vertices, out, until = [], [], []
    for held, (across, down) in enumerate(setup['held']):
        at = across * (columns - 1), down * (rows - 1)
        if max(abs(at[0] - round(at[0])), abs(at[1] - round(at[1]))) > 1e-9:
            raise ValueError('no vertex of the grid is held')
        vertices.append(int(round(at[1])) * columns + int(round(at[0])))
        out.append(paths[:, held])
        until.append(setup['until_s'].get(held, numpy.inf))
    if setup.get('edge'):
        first, last = vertices[:2]
        for vertex in range(first + 1, last):
            part = (vertex - first) / (last - first)
            vertices.append(vertex)
            out.append((1. - part) * paths[:, 0] + part * paths[:, 1])
            until.append(numpy.inf)
    order = numpy.argsort(vertices)
    return ([vertices[k] for k in order], numpy.stack(out, axis=1)[:, order],
            [until[k] for k in order])


def start_of(setup, grid):
    """Where a grid is at first: flat, as its clamps are, or bulging at its lower edge."""
    start = flat_points(setup, grid) + setup['paths'][0, 0]
    v, u = numpy.divmod(numpy.arange(len(start)), grid[0])
    start[:, 1] += setup.get('bulge_m', 0.) * numpy.sin(
        numpy.pi * u / (grid[0] - 1)) * v / (grid[1] - 1)
    return start


def simulate_own(tool, family, setup, numbers, effects, grid, strange):
    """By gst-cloth-gap-1.0 simulate."""
    model = dict(copy.deepcopy(numbers), **copy.deepcopy(OWN[family]))
    model['effects'].update(copy.deepcopy(effects))
    vertices, paths, until = holds_of(setup, grid)
    for vertex, path, since in strange.get('led', ()):
        vertices, until = vertices + [vertex], until + [numpy.inf]
        paths = numpy.concatenate([paths, path[:, None]], axis=1)
    begun = {vertex: since for vertex, _, since in strange.get('led', ())}
    held = [{'vertex': vertex, **({'from_s': begun[vertex]} if begun.get(vertex) else {}),
             **({'until_s': end} if numpy.isfinite(end) else {})}
            for vertex, end in zip(vertices, until)]
    obstacles = [{'type': 'sphere', 'centre': list(ball[:3]), 'radius_m': ball[3]}
                 for ball in strange.get('balls', ())]
    obstacles += [{'type': 'plane', 'normal': list(plane[:3]),
                   'point': [plane[3] * part for part in plane[:3]]}
                  for plane in strange.get('planes', ())]
    start = numpy.full((len(paths), grid[0] * grid[1], 3), numpy.nan)
    start[0] = start_of(setup, grid)
    with tempfile.TemporaryDirectory(prefix='cloth-gapbench-') as scratch:
        write_take(os.path.join(scratch, 'scene'), {
            'name': 'scene', 'fps': HZ, 'held': held, 'obstacles': obstacles,
            'grid': dict(setup['cloth'], columns=grid[0], rows=grid[1])}, start, paths)
        with open(os.path.join(scratch, 'model.json'), 'w', encoding='utf-8') as file:
            json.dump(model, file)
        done = subprocess.run(
            [tool, 'simulate', os.path.join(scratch, 'model.json'), '--scene',
             os.path.join(scratch, 'scene'), '--output', os.path.join(scratch, 'made'),
             '--threads', '1'],
            capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)
        if done.returncode:
            raise CannotSimulate(done.stderr.strip().split('\n')[-1])
        return numpy.load(os.path.join(scratch, 'made/positions.npy')).astype(float)


def flatten(numbers, before=''):
    for key, value in numbers.items():
        if isinstance(value, dict):
            yield from flatten(value, before + key + '.')
        elif isinstance(value, (int, float)):
            yield before + key, [value]


def gust_speeds(law, n_frames):
    """An Ornstein-Uhlenbeck process of the benchmark's own."""
    random = numpy.random.default_rng(20)
    keep = numpy.exp(-1. / HZ / law['time'])
    speeds = [random.normal()]
    for _ in range(n_frames - 1):
        speeds.append(keep * speeds[-1] + (1. - keep ** 2) ** 0.5 * random.normal())
    return [law['intensity'] * speed for speed in speeds]


def move_clamps(setup, effects):
    """Paths with what clamps really do: late, or off from a time on."""
    paths = setup['paths']
    t = numpy.arange(len(paths)) / HZ
    if 'clamp_delay' in effects:
        late = numpy.clip(t - effects['clamp_delay']['delay'], t[0], t[-1])
        paths = interpolate(paths, late)
    if 'clamp_slip' in effects:
        slip = effects['clamp_slip']
        on = numpy.clip((t - slip.get('time', 0.)) / 0.05, 0., 1.)
        way = on[:, None] * [slip.get(axis, 0.) for axis in 'xyz']
        paths = paths.copy()
        held = int(slip.get('held', -1))
        for k in range(paths.shape[1]) if held < 0 else (held,):
            paths[:, k] += way
    return paths


def simulate_outside(program, name, setup, numbers, effects, grid, strange):
    """By a program of the benchmark, on a finer grid."""
    finer = FINER[name]
    fine = (finer * (grid[0] - 1) + 1, finer * (grid[1] - 1) + 1)
    vertices, paths, until = holds_of(setup, fine, move_clamps(setup, effects))
    lists = dict(flatten(numbers))
    for effect, values in effects.items():
        lists.update(('%s.%s' % (effect, key), [value]) for key, value in values.items())
    if 'gust' in effects:
        lists['gust.speeds'] = gust_speeds(effects['gust'], len(paths))
    cloth = setup['cloth']
    lists.update({key: numpy.ravel(value).tolist() for key, value in strange.items()
                  if key != 'led'})
    lists.update({'grid': [*fine, cloth['width_m'], cloth['height_m']],
                  'frames': [len(paths), 1. / HZ], 'held': vertices,
                  'until': [min(end, 1e9) for end in until], 'paths': paths.ravel().tolist(),
                  'start': start_of(setup, fine).ravel().tolist()})
    text = ''.join('%s %d %s\n' % (key, len(values), ' '.join('%.9g' % value for value in values))
                   for key, values in lists.items())
    if not program or not os.path.exists(program):
        raise CannotSimulate('%s was not built' % name)
    done = subprocess.run([program], input=text.encode(), capture_output=True, check=False)
    if done.returncode:
        raise CannotSimulate('%s: %s' % (name, done.stderr.decode().strip()))
    out = numpy.frombuffer(done.stdout, 'float32').astype(float)
    out = out.reshape(len(paths), fine[1], fine[0], 3)
    return out[:, ::finer, ::finer].reshape(len(paths), -1, 3)


class Realities:
    """All families, by name."""

    def __init__(self, tool, programs):
        self.tool, self.programs = tool, programs

    def has(self, family):
        return family in OWN or os.path.exists(os.path.join(self.programs, family))

    def simulate(self, family, setup, numbers, effects=None, grid=None, strange=None):
        cloth = setup['cloth']
        grid = grid or (cloth['columns'], cloth['rows'])
        if family in OWN:
            out = simulate_own(self.tool, family, setup, numbers, effects or {}, grid,
                               strange or {})
        else:
            assert set(effects or {}) <= set(EXPRESSES[family]), family
            out = simulate_outside(os.path.join(self.programs, family), family, setup, numbers,
                                   effects or {}, grid, strange or {})
        if not numpy.isfinite(out).all() or numpy.ptp(out, axis=(0, 1)).max() > 20.:
            raise CannotSimulate('the simulation has run away')
        return out


def interpolate(values, times):
    """Values of HZ a second at any times, on a Catmull-Rom cubic."""
    at = numpy.clip(numpy.asarray(times) * HZ, 0., len(values) - 1.)
    k = numpy.minimum(at.astype(int), len(values) - 2)
    s = (at - k).reshape((-1,) + (1,) * (values.ndim - 1))
    p = [values[numpy.clip(k + i, 0, len(values) - 1)] for i in (-1, 0, 1, 2)]
    return p[1] + 0.5 * s * (p[2] - p[0] + s * (2. * p[0] - 5. * p[1] + 4. * p[2] - p[3] +
                                                s * (3. * (p[1] - p[2]) + p[3] - p[0])))


def write_take(folder, take, positions, clamps, times=None, spread=None):
    os.makedirs(folder)
    with open(os.path.join(folder, 'take.json'), 'w', encoding='utf-8') as file:
        json.dump(dict({'version': 1}, **take), file)
    numpy.save(os.path.join(folder, 'positions.npy'), positions.astype('float32'))
    numpy.save(os.path.join(folder, 'clamps.npy'), clamps.astype('float32'))
    if times is not None:
        numpy.save(os.path.join(folder, 'times.npy'), numpy.asarray(times, float))
    if spread is not None:
        upper = numpy.stack([spread[..., a, b] for a in range(3) for b in range(a, 3)], axis=-1)
        upper[numpy.isnan(positions[..., 0])] = numpy.nan
        numpy.save(os.path.join(folder, 'covariance.npy'), upper.astype('float32'))
