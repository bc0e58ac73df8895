#!/usr/bin/python3
"""A user's simulator in the loop: reality is another simulator with a number that the user's does
not have right; the diagnosis names the effect, finds the number in that simulator, and what it
says to change is all that is needed. And each way in which a command can spoil that is told.

  loop.py TOOL ROOT

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import shlex
import subprocess
import sys
import tempfile

import jsonschema
import numpy

tool, root = (os.path.abspath(path) for path in sys.argv[1:])
springs = os.path.join(root, 'tests/simulators/springs.py')
N, FRAMES, NOISE = 9, 60, 3e-4
faults = []

MODEL = {'version': 1, 'areal_density': 0.15, 'stretch': {'warp': 15, 'weft': 15}, 'shear': 5,
         'bending': {'warp': 1e-5, 'weft': 1e-5}, 'damping': {'mass': 0.3, 'stiffness': 5e-4},
         'free': [{'name': name, 'range': limits} for name, limits in (
             ('stretch.warp', [3, 100]), ('stretch.weft', [3, 100]), ('shear', [0.5, 30]),
             ('bending.warp', [1e-6, 1e-3]), ('bending.weft', [1e-6, 1e-3]),
             ('damping.mass', [0, 3]), ('damping.stiffness', [0, 0.02]))]}

# A command between: it counts runs, and does what it is told to `p` and with the result `x`.
BETWEEN = '''
import json, os, sys
sys.path.insert(0, FOLDER)
import springs
if sys.argv[1] == '--capabilities':
    keys = ('name', 'unit', 'value', 'range', 'is', 'scale')
    said = {'version': 1, 'simulator': 'mine', 'parameters': [
        dict(zip(keys, row)) for row in springs.PARAMETERS]}
    parameters = {p['name']: p for p in said['parameters']}
    SAY
    print(json.dumps(said)); sys.exit(0)
folder = sys.argv[1]
open('runs', 'a').write('.')
path = folder + '/parameters.json'
p = json.load(open(path))
DO
json.dump(p, open(path, 'w'))
springs.simulate(folder)
'''


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what), flush=True)
    if not true:
        faults.append(what)


def simulate(folder, hidden, rate):
    """What springs.py makes of a sheet that is held at its upper corners and the middle between."""
    scene = os.path.join(folder, 'scene')
    os.makedirs(scene)
    t = numpy.arange(FRAMES) / 50.
    v, u = numpy.divmod(numpy.arange(N * N), N)
    start = numpy.stack([0.02 * u, 0. * u, -0.02 * v], axis=1)
    held = [0, N // 2, N - 1]
    clamps = numpy.repeat(start[None, held], FRAMES, axis=0)
    ramp = numpy.minimum(1., t / 0.3)
    for i in range(len(held)):
        clamps[:, i, 1] = 0.03 * ramp * numpy.sin(rate * t + 0.35 * i)
        clamps[:, i, 0] += 0.02 * ramp * numpy.sin(0.6 * rate * t)
    positions = numpy.full((FRAMES, N * N, 3), numpy.nan, numpy.float32)
    positions[0] = start
    take = {'version': 1, 'name': os.path.basename(folder), 'fps': 50,
            'grid': {'columns': N, 'rows': N, 'width_m': 0.16, 'height_m': 0.16},
            'held': [{'vertex': vertex} for vertex in held]}
    for name, json_object in (('scene/take.json', take), ('parameters.json', hidden)):
        with open(os.path.join(folder, name), 'w', encoding='utf-8') as file:
            json.dump(json_object, file)
    for name, array in (('positions', positions), ('times', t),
                        ('clamps', clamps.astype(numpy.float32))):
        numpy.save(os.path.join(scene, name + '.npy'), array)
    subprocess.run([sys.executable, '-I', springs, folder], check=True)
    return os.path.join(folder, 'simulated')


def record(folder, hidden, seed, rate=6.):
    take = simulate(folder, hidden, rate)
    path = os.path.join(take, 'positions.npy')
    x = numpy.load(path)
    # the start is known: nothing moves yet
    x[1:] += NOISE * numpy.random.default_rng(seed).standard_normal(x[1:].shape)
    numpy.save(path, x)
    return take


def diagnose(folder, takes, *arguments, command=None):
    done = subprocess.run(
        [tool, 'diagnose', *takes, '--model', 'model.json', '--output', 'out', '--simulator',
         command or '%s -I %s' % (sys.executable, shlex.quote(springs)), *arguments],
        cwd=folder, capture_output=True, text=True, timeout=600, stdin=subprocess.DEVNULL,
        env=dict(os.environ, LC_ALL='C.UTF-8', TMPDIR=folder))
    left = [name for name in os.listdir(folder) if name.startswith('gst-cloth-gap-')]
    expect(not left, 'no folder is left %s' % left)
    return done


def read_gap(folder):
    with open(os.path.join(folder, 'out/gap.json'), encoding='utf-8') as file:
        gap = json.load(file)
    with open(os.path.join(root, 'docs/gap.schema.json'), encoding='utf-8') as file:
        jsonschema.Draft202012Validator(json.load(file)).validate(gap)
    return gap


def between(folder, say='', do=''):
    path = os.path.join(folder, 'between.py')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(BETWEEN.replace('FOLDER', repr(os.path.dirname(springs))).replace('SAY', say)
                   .replace('DO', do))
    if os.path.exists(os.path.join(folder, 'runs')):
        os.remove(os.path.join(folder, 'runs'))
    return '%s %s' % (sys.executable, shlex.quote(path))


def count_runs(folder):
    return os.path.getsize(os.path.join(folder, 'runs'))


def find_distance(folder, parameters, rate=6.):
    """RMS of recorded less what springs.py makes with these numbers, m."""
    name = os.path.join(folder, 'again%d' % len(os.listdir(folder)))
    x = numpy.load(os.path.join(simulate(name, parameters, rate), 'positions.npy'))
    y = numpy.load(os.path.join(folder, 'take/simulated/positions.npy'))
    return numpy.sqrt(((x[1:] - y[1:]) ** 2).sum(axis=2).mean())


def check_hidden(parent, number, value, effect, off):
    """Only @number is not what the user's simulator has."""
    folder = os.path.join(parent, number)
    os.mkdir(folder)
    write_model(folder)
    take = record(os.path.join(folder, 'take'), {number: value}, 1)
    done = diagnose(folder, [take], '--effects', 'air_drag,wind,areal_mass,bending')
    expect(done.returncode == 0, '%s: %s%s' % (number, done.stdout, done.stderr[-300:]))
    gap = read_gap(folder)
    accepted = [e['name'] for e in gap['effects'] if e['accepted']]
    expect(accepted == [effect], '%s: named %s' % (number, accepted))
    expect(gap['verdict'] in ('explained', 'ambiguous'), gap['verdict'])
    expect(gap['patch_simulator'] == 'springs' and gap['has_simulated'], 'in its names')
    patch = {row['name']: row['after'] for row in gap['patch']}
    expect(list(patch) == [number] and abs(numpy.log(patch[number] / value)) < off,
           '%s: %s for %g' % (number, patch, value))
    shrink = gap['measured_shrink']
    expect(shrink['windows']['value'] > 0.9 and shrink['free']['value'] > 0.9,
           '%s: measured %s, predicted %s' % (number, shrink, gap['predicted_shrink']))
    # what is printed is all that is needed
    before, after = find_distance(folder, {}), find_distance(folder, patch)
    expect(after < 0.3 * before and after < 4. * NOISE,
           '%s: %.2f mm before, %.2f mm after' % (number, 1e3 * before, 1e3 * after))
    return folder, take


def write_model(folder):
    with open(os.path.join(folder, 'model.json'), 'w', encoding='utf-8') as file:
        json.dump(MODEL, file)


def check_hold_out(parent):
    """A hold-out judges, and is not fitted on; the number of runs is bound."""
    folder = os.path.join(parent, 'hold-out')
    os.mkdir(folder)
    write_model(folder)
    take = record(os.path.join(folder, 'take'), {'drag': 1.5}, 2)
    other = record(os.path.join(folder, 'other'), {'drag': 1.5}, 3, rate=7.)
    done = diagnose(folder, [take], '--hold-out', other, '--effects', 'air_drag,bending',
                    '--simulator-runs', '4', command=between(folder))
    gap = read_gap(folder)
    patch = {row['name']: row['after'] for row in gap['patch']}
    expect(done.returncode == 0 and gap['measured_shrink']['free']['value'] > 0.9 and
           abs(patch.get('drag', 0.) - 1.5) < 0.3, 'a hold-out: %s, %s' % (patch, done.stderr[-300:]))
    # two twins, at most four runs of the take, one of the hold-out
    expect(4 <= count_runs(folder) <= 7, '%d runs' % count_runs(folder))
    roles = [i['role'] for i in gap['inputs']]
    expect(roles.count('simulated') == 2 and roles.count('simulated_after') == 1, str(roles))


def check_nothing(parent):
    folder = os.path.join(parent, 'nothing')
    os.mkdir(folder)
    write_model(folder)
    take = record(os.path.join(folder, 'take'), {}, 4)
    done = diagnose(folder, [take], '--effects', 'air_drag,areal_mass', command=between(folder))
    gap = read_gap(folder)
    expect(gap['verdict'] == 'no_gap' and gap['patch'] == [] and count_runs(folder) == 1 and
           gap['measured_shrink']['free']['value'] is None,
           'nothing hidden: %s, %s' % (done.stdout, gap['patch']))


def break_loop(folder, take):
    """@take has drag that the user's simulator does not."""
    few = ('--effects', 'air_drag,areal_mass')

    def refuse(what, words, *arguments, code=1, takes=(take,), **kind):
        done = diagnose(folder, takes, *few, *arguments, command=between(folder, **kind))
        said = done.stdout + done.stderr
        expect(done.returncode == code and all(word in said for word in words),
               '%s: %s' % (what, said[-300:]))

    refuse('ignores a number', ['changing “drag” from 0 to ', 'changed nothing', 'parameters.json'],
           do="p['drag'] = 0")
    refuse('fails with any drag', ['exit code 3', 'no licence', 'drag = '],
           do="if p['drag'] > 0: sys.exit('no licence') if False else (print('no licence'), sys.exit(3))")
    refuse('fails at once', ['exit code 4'], do='sys.exit(4)')
    refuse('hangs', ['not done after 1 s', '--run-seconds'], '--run-seconds', '1',
           do='import time; time.sleep(60)')
    refuse('NaN', ['blew up', 'vertex 7'],
           do="import numpy; s = springs.numpy.save; springs.numpy.save = lambda f, x: "
              "(x.__setitem__((5, 7), numpy.nan), s(f, x))")
    refuse('too few frames', ['scene/times.npy'],
           do="import numpy; s = springs.numpy.save; springs.numpy.save = lambda f, x: "
              "(s(f, x[:50]), s(f.replace('positions', 'times'), numpy.arange(50) / 50.), "
              "s(f.replace('positions', 'clamps'), "
              "numpy.load(folder + '/scene/clamps.npy')[:50]))")
    refuse('another mesh', ['same mesh'],
           do="import numpy; s = springs.numpy.save; q = folder + '/simulated/take.json'\n"
              "def save(f, x):\n    j = json.load(open(q)); j['grid']['rows'] = 8; "
              "json.dump(j, open(q, 'w')); s(f, x[:, :72])\nsprings.numpy.save = save")
    refuse('an effect that is none', ['air_drug', '“drag”'],
           say="parameters['drag']['is'] = 'effects.air_drug.coefficient'")
    refuse('twins given too', ['--simulated'], '--simulated', take, code=2)
    refuse('runs below none', ['--simulator-runs'], '--simulator-runs', '-1', code=2)
    refuse('no time', ['--run-seconds'], '--run-seconds', '0', code=2)
    expect(not os.path.exists(os.path.join(folder, 'out/gap.json')), 'nothing is written')


def bend_loop(folder, take):
    """What is not right, and yet no end."""
    few = ('--effects', 'air_drag,areal_mass')

    def find(what, *arguments, **kind):
        done = diagnose(folder, [take], *few, *arguments, command=between(folder, **kind))
        expect(done.returncode == 0, '%s: %s' % (what, done.stderr[-300:]))
        gap = read_gap(folder)
        return gap, {row['name']: row for row in gap['patch']}

    gap, patch = find('a wrong unit', say="parameters['drag']['scale'] = 0.2")
    expect(abs(patch['drag']['after'] - 1.5) < 0.2, 'is mended: %s' % patch)
    gap, patch = find('no unit', say="del parameters['drag']['scale']")
    expect(abs(patch['drag']['after'] - 1.5) < 0.2, 'is measured: %s' % patch)
    gap, patch = find('a range that is too wide', do="assert p['drag'] < 1.2")
    expect(0. < patch['drag']['after'] < 1.2 and gap['failures'], 'is told: %s' % gap['failures'][:1])
    gap, patch = find('a range that is too narrow', say="parameters['drag']['range'] = [0, 0.5]")
    expect(patch['drag']['after'] == 0.5 and gap['verdict'] == 'unexplained' and
           gap['gap_after']['value'] > 1.5 * gap['noise_floor']['value'], 'is kept: %s' % patch)
    gap, patch = find('no such number', say="said['parameters'].remove(parameters['drag'])",
                      do="p['drag'] = 0")
    row = patch.get('air_drag')
    expect(list(patch) == ['air_drag'] and row['after'] is None and 'add it' in row['text'] and
           'coefficient' in row['text'] and count_runs(folder) == 1 and
           gap['measured_shrink']['free']['value'] is None, 'is to be added: %s' % patch)
    gap, patch = find('no runs', '--simulator-runs', '0')
    expect(not patch and count_runs(folder) == 1, 'nothing is fitted: %s' % patch)


with tempfile.TemporaryDirectory() as scratch:
    drag = check_hidden(scratch, 'drag', 1.5, 'air_drag', 0.1)
    check_hidden(scratch, 'weight', 225., 'areal_mass', 0.05)
    check_hold_out(scratch)
    check_nothing(scratch)
    os.remove(os.path.join(drag[0], 'out/gap.json'))
    break_loop(*drag)
    bend_loop(*drag)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
