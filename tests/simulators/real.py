#!/usr/bin/python3
"""A simulator that somebody else wrote, behind its adapter: it keeps the contract, falls as
things fall, holds what is held, and stops where something is in the way.

  real.py TOOL ROOT COMMAND      exit code 77: the simulator is not installed

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

import jsonschema
import numpy

tool, root, command = (os.path.abspath(path) for path in sys.argv[1:])
N, SIDE, FPS = 9, 0.4, 50.
faults = []


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what))
    if not true:
        faults.append(what)


def simulate(folder, n_frames, held, parameters, flat=False, jitter=0., **more):
    """What a sheet does; flat: it lies, else it hangs. Positions, times, clamps."""
    scene = os.path.join(folder, 'scene')
    os.makedirs(scene)
    t = numpy.arange(n_frames) / FPS
    t[1:-1] += jitter * numpy.sin(7. * numpy.arange(1, n_frames - 1))
    v, u = numpy.divmod(numpy.arange(N * N), N) * numpy.array(SIDE / (N - 1))
    start = numpy.stack([u, -v if flat else 0. * u, 0. * u if flat else -v], axis=1)
    positions = numpy.full((n_frames, N * N, 3), numpy.nan, numpy.float32)
    positions[0] = start
    take = dict({'version': 1, 'name': 'made', 'fps': FPS,
                 'grid': {'columns': N, 'rows': N, 'width_m': SIDE, 'height_m': SIDE},
                 'held': [{'vertex': vertex} for vertex in held]}, **more)
    clamps = numpy.repeat(start[None, held], n_frames, axis=0)
    clamps[:, :, 1] += 0.05 * numpy.sin(6. * t)[:, None]
    if len(held) > 1:
        clamps[:, 1, 0] -= 0.02 * (1. - numpy.cos(3. * t))
    with open(os.path.join(scene, 'take.json'), 'w', encoding='utf-8') as file:
        json.dump(take, file)
    with open(os.path.join(folder, 'parameters.json'), 'w', encoding='utf-8') as file:
        json.dump(parameters, file)
    numpy.save(os.path.join(scene, 'positions.npy'), positions)
    numpy.save(os.path.join(scene, 'times.npy'), t)
    if held:
        numpy.save(os.path.join(scene, 'clamps.npy'), clamps.astype(numpy.float32))
    done = subprocess.run([command, folder], capture_output=True, text=True, timeout=600)
    if done.returncode:
        sys.exit('it failed: %s%s' % (done.stdout[-500:], done.stderr[-500:]))
    result = numpy.load(os.path.join(folder, 'simulated/positions.npy')).astype(float)
    expect(result.shape == positions.shape and numpy.isfinite(result).all(), 'all of the sheet')
    expect(numpy.abs(result[0] - start).max() < 1e-5, 'it begins where it is')
    return result, t, clamps


def find_still_air(capabilities):
    """All that brakes, at 0; of Blender also a number of steps that rounding makes one more of."""
    still = {'air_damping': 0., 'kDP': 0., 'kDG': 0., 'quality': 24}
    return {p['name']: still[p['name']] for p in capabilities['parameters'] if p['name'] in still}


def main(parent):
    done = subprocess.run([command, '--capabilities'], capture_output=True, text=True, check=True)
    capabilities = json.loads(done.stdout)
    with open(os.path.join(root, 'docs/simulator-capabilities.schema.json'), encoding='utf-8') as file:
        jsonschema.Draft202012Validator(json.load(file)).validate(capabilities)
    still = find_still_air(capabilities)

    x, t, _ = simulate(os.path.join(parent, 'fall'), 30, [], still)
    fall = numpy.polyfit(t, x[:, :, 2].mean(axis=1), 2)[0] * 2.
    expect(abs(fall + 9.81) < 0.02, 'falls with %.4f m/s²' % fall)
    x, t, _ = simulate(os.path.join(parent, 'scaled'), 30, [], dict(still, gravity=0.5))
    fall = numpy.polyfit(t, x[:, :, 2].mean(axis=1), 2)[0] * 2.
    expect(abs(fall + 4.905) < 0.02, 'and with %.4f m/s² at half of it' % fall)
    x, t, _ = simulate(os.path.join(parent, 'tilt'), 30, [], dict(still, gravity_y=1.),
                       gravity=[0., 0., -5.])
    push = [numpy.polyfit(t, x[:, :, axis].mean(axis=1), 2)[0] * 2. for axis in range(3)]
    expect(numpy.abs(numpy.subtract(push, [0., 1., -5.])).max() < 0.02, 'tilted: %s' % push)

    x, t, clamps = simulate(os.path.join(parent, 'held'), 60, [0, N - 1], {}, jitter=0.002)
    off = numpy.abs(x[:, [0, N - 1]] - clamps).max()
    expect(off < 5e-4, 'clamps are followed to %.2g mm, at uneven times' % (1000. * off))
    edges = numpy.linalg.norm(numpy.diff(x.reshape(len(x), N, N, 3), axis=1), axis=3)
    expect(0.9 < numpy.median(edges) * (N - 1) / SIDE < 1.1, 'as long as the cloth')

    ball = {'type': 'sphere', 'centre': [0.2, -0.2, -0.25], 'radius_m': 0.15}
    x, t, _ = simulate(os.path.join(parent, 'ball'), 40, [], {}, flat=True, obstacles=[ball])
    apart = numpy.linalg.norm(x - ball['centre'], axis=2)
    middle = x[-1, N * N // 2, 2]
    expect(apart.min() > 0.145 and middle > -0.115, 'a ball holds it: %.3f, %.3f m' %
           (apart.min(), middle))
    floor = {'type': 'plane', 'point': [0., 0., -0.1], 'normal': [0., 0., 1.]}
    x, t, _ = simulate(os.path.join(parent, 'floor'), 40, [], {}, flat=True, obstacles=[floor])
    expect(x[-1, :, 2].min() > -0.11 and x[-1, :, 2].max() < -0.08, 'so does a floor: %.3f m' %
           x[-1, :, 2].min())

    done = subprocess.run([tool, 'check-simulator', command, '--scene',
                           os.path.join(root, 'tests/data/take_drag')], capture_output=True,
                          text=True, timeout=1200)
    expect(done.returncode == 0, 'check-simulator: %s%s' % (done.stdout, done.stderr))


if command.endswith('.py') and not shutil.which(os.environ.get('BLENDER', 'blender')):
    print('Blender is not installed: skipped')
    sys.exit(77)
with tempfile.TemporaryDirectory() as scratch:
    main(scratch)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
