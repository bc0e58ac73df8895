#!/usr/bin/python3
"""Reality is a simulator that somebody else wrote, with one number that is not what its user has:
the diagnosis with that user's simulator in the loop names the effect and finds the number, and what
it says to change is all that is needed.

  reality.py TOOL ROOT COMMAND [FOLDER]     exit code 77: the simulator is not installed

FOLDER gets what picture.py draws. A row for each case goes to the standard output: the tables of
docs/own-simulator.md. First stand the cases that must be found, among the effects that the simulator has
numbers for; then all cases among all effects, which are only told, but for the one without an effect.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

import numpy

tool, root, command = (os.path.abspath(path) for path in sys.argv[1:4])
pictures = os.path.abspath(sys.argv[4]) if len(sys.argv) > 4 else None
N, FRAMES, SIDE, NOISE = 17, 120, 0.4, 5e-4
# name of the case, the number, its value in reality, effects any of which is right, whether it must
# be found. Blender's bending at 2 moves this cloth by 1.3 mm, which is below what can show.
CASES = {
    'Blender cloth': [
        ('nothing', None, None, (), False),
        ('heavier', 'mass', 0.45, ('areal_mass',), True),
        ('stiffer', 'bending_stiffness', 8., ('bending',), True),
        ('thicker air', 'air_damping', 3., ('air_drag_linear', 'damping_mass'), True),
        ('softer', 'tension_stiffness', 1., ('stretch',), False),
        ('wind', 'wind_y', 400., ('wind',), False),
        ('tilted', 'gravity_y', 0.6, ('gravity_tilt',), False),
        ('shrunk', 'shrink_min', 0.02, ('shrinkage',), False)],
    'Bullet soft body': [
        ('nothing', None, None, (), False),
        ('heavier', 'mass', 0.28, ('areal_mass',), False),
        ('stiffer', 'kLST_bending', 0.08, ('bending',), False),
        ('more drag', 'kDG', 1., ('air_drag',), False),
        ('more damping', 'kDP', 0.004, ('damping_mass', 'air_drag_linear'), False),
        ('wind', 'wind_y', 1.5, ('wind',), False),
        ('tilted', 'gravity_y', 0.6, ('gravity_tilt',), False),
        ('shrunk', 'rest_scale', 0.02, ('shrinkage',), False)]}
# What the free numbers of are fitted to the simulator. Blender's air brakes by area: heavier cloth less.
MODELS = {'Blender cloth': 'pipelines/model-blender.json',
          'Bullet soft body': 'pipelines/model-knit.json'}
faults = []


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what), flush=True)
    if not true:
        faults.append(what)


def simulate(folder, parameters):
    """What the simulator makes of a sheet that is held at its upper corners and the middle between
    and swings."""
    scene = os.path.join(folder, 'scene')
    os.makedirs(scene)
    t = numpy.arange(FRAMES) / 50.
    v, u = numpy.divmod(numpy.arange(N * N), N)
    start = numpy.stack([u * SIDE / (N - 1), 0. * u, -v * SIDE / (N - 1)], axis=1)
    held = [0, N // 2, N - 1]
    clamps = numpy.repeat(start[None, held], FRAMES, axis=0)
    ramp = numpy.minimum(1., t / 0.3)
    for i in range(len(held)):
        clamps[:, i, 1] = 0.06 * ramp * numpy.sin(5. * t + 0.35 * i)
        clamps[:, i, 0] += 0.036 * ramp * numpy.sin(3. * t)
    positions = numpy.full((FRAMES, N * N, 3), numpy.nan, numpy.float32)
    positions[0] = start
    take = {'version': 1, 'name': os.path.basename(folder), 'fps': 50,
            'grid': {'columns': N, 'rows': N, 'width_m': SIDE, 'height_m': SIDE},
            'held': [{'vertex': vertex} for vertex in held]}
    for name, json_object in (('scene/take.json', take), ('parameters.json', parameters)):
        with open(os.path.join(folder, name), 'w', encoding='utf-8') as file:
            json.dump(json_object, file)
    for name, array in (('positions', positions), ('times', t),
                        ('clamps', clamps.astype(numpy.float32))):
        numpy.save(os.path.join(scene, name + '.npy'), array)
    subprocess.run([command, folder], check=True, stdout=subprocess.DEVNULL, timeout=600)
    return numpy.load(os.path.join(folder, 'simulated/positions.npy')).astype(float)


def find_distance(a, b):
    return 1e3 * numpy.sqrt(((a[1:] - b[1:]) ** 2).sum(axis=2).mean())


def percent(estimate):
    return '–' if estimate['value'] is None else '%.0f%%' % (100. * estimate['value'])


def keep_picture(name, title, **takes):
    folder = os.path.join(pictures, name)
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, 'title.txt'), 'w', encoding='utf-8') as file:
        file.write(title)
    for what, take in takes.items():
        numpy.save(os.path.join(folder, what + '.npy'), take)


def find_effects(said):
    """The effects that the simulator has numbers for, by its capabilities."""
    of_model = {'areal_density': 'areal_mass', 'damping.mass': 'damping_mass',
                'damping.stiffness': 'damping_stiffness'}
    names = set()
    for parameter in said['parameters']:
        is_ = parameter.get('is') or []
        for key in [is_] if isinstance(is_, str) else is_:
            first, *more = key.split('.')
            names.add(more[0] if first == 'effects' else of_model.get(key, first))
    return sorted(names)


def run(parent, seed, case, own, effects=None):
    """effects: among which it must be found; None: among all, and it is only told."""
    name, number, value, right, _ = case
    folder = os.path.join(parent, name + (' among own' if effects else ''))
    hidden = {number: value} if number else {}
    truth = simulate(os.path.join(folder, 'take'), hidden)
    recorded = truth + NOISE * numpy.random.default_rng(seed).standard_normal(truth.shape)
    take = os.path.join(folder, 'take/simulated')
    numpy.save(os.path.join(take, 'positions.npy'), recorded.astype(numpy.float32))
    done = subprocess.run(
        [tool, 'diagnose', take, '--model', model,
         '--simulator', command, '--output', os.path.join(folder, 'gap'),
         *(['--effects', ','.join(effects)] if effects else [])],
        capture_output=True, text=True, timeout=1800)
    expect(done.returncode == 0, '%s: %s' % (name, done.stdout + done.stderr[-300:]))
    with open(os.path.join(folder, 'gap/gap.json'), encoding='utf-8') as file:
        gap = json.load(file)
    named = [e['name'] for e in gap['effects'] if e['accepted']]
    patch = {row['name']: row['after'] for row in gap['patch'] if row['after'] is not None}
    # the start is not noisy here: only what is printed is judged
    before, after = (simulate(os.path.join(folder, what), numbers)
                     for what, numbers in (('before', {}), ('after', patch)))
    apart = find_distance(truth, before), find_distance(truth, after)
    forecast, measured = gap['predicted_shrink'], gap['measured_shrink']
    said = ', '.join('`%s` = %g' % item for item in patch.items()) or '–'
    print('| %s | %s | %s, %s | %s | %.1f | %s, %s | %s, %s | %.1f, %.1f |' % (
        name, '`%s` %g → %g' % (number, own[number], value) if number else '–', gap['verdict'],
        ', '.join('`%s`' % effect for effect in named) or '–', said,
        1e3 * gap['gap_before']['value'], percent(forecast['windows']),
        percent(forecast['free']), percent(measured['windows']), percent(measured['free']),
        *apart), flush=True)
    if pictures and patch and effects:
        keep_picture(name, '%s: %s %g in reality, %g in the simulation' % (
            name, number, value, own[number]) + '; found: ' + said.replace('`', ''),
                     recorded=truth, before=before, after=after)
    if not number:
        expect(gap['verdict'] == 'no_gap' and not named and not patch, '%s: %s' % (name, named))
    if not effects:
        return
    expect(len(named) == 1 and named[0] in right, '%s: named %s' % (name, named))
    expect(number in patch and abs(numpy.log(patch[number] / value)) < 0.15,
           '%s: %s for %g' % (name, patch, value))
    expect(all((measured[kind]['value'] or 0.) > 0.9 for kind in ('windows', 'free')),
           '%s: measured %s' % (name, measured))
    expect(apart[1] < 0.25 * apart[0], '%s: %.2f mm before, %.2f mm after' % (name, *apart))


if command.endswith('.py') and not shutil.which(os.environ.get('BLENDER', 'blender')):
    print('Blender is not installed: skipped')
    sys.exit(77)
capabilities = json.loads(subprocess.run([command, '--capabilities'], capture_output=True,
                                         check=True, text=True).stdout)
model = os.path.join(root, MODELS[capabilities['simulator']])
defaults = {p['name']: p['value'] for p in capabilities['parameters']}
with tempfile.TemporaryDirectory() as scratch:
    cases = list(enumerate(CASES[capabilities['simulator']], 1))
    for i, row in cases:
        if row[-1]:
            run(scratch, i, row, defaults, find_effects(capabilities))
    for i, row in cases:
        run(scratch, i, row, defaults)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
