#!/usr/bin/python3
"""The benchmark's own simulators, against closed forms and against scenes that are none.

  familiestest.py PROGRAMS

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import math
import os
import subprocess
import sys

import numpy

programs = sys.argv[1]
faults = []
COLUMNS, ROWS, WIDTH, HEIGHT, HZ = 9, 11, 0.2, 0.25, 200.
FLAT = numpy.zeros((ROWS, COLUMNS, 3))
FLAT[..., 0] = numpy.linspace(0., WIDTH, COLUMNS)
FLAT[..., 2] = -numpy.linspace(0., HEIGHT, ROWS)[:, None]
LEVEL = FLAT[..., (0, 2, 1)] * [1., -1., 1.]


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what))
    if not true:
        faults.append(what)


def near(value, truth, share, what):
    expect(abs(value - truth) <= share * abs(truth), '%s: %.5g, %.5g' % (what, value, truth))


def scene_of(n_frames, held=(), **lists):
    """A scene at rest, its clamps too."""
    paths = numpy.tile(FLAT.reshape(-1, 3)[list(held)], (n_frames, 1, 1))
    known = {'grid': [COLUMNS, ROWS, WIDTH, HEIGHT], 'frames': [n_frames, 1. / HZ],
             'held': list(held), 'until': [1e9] * len(held), 'paths': paths.ravel().tolist(),
             'start': FLAT.ravel().tolist(), 'damping.mass': [0.]}
    known.update({key.replace('__', '.'): value if isinstance(value, list) else [value]
                  for key, value in lists.items()})
    return ''.join('%s %d %s\n' % (key, len(values), ' '.join('%.9g' % value for value in values))
                   for key, values in known.items())


def run(name, n_frames, held=(), **lists):
    done = subprocess.run([os.path.join(programs, name)], check=True, capture_output=True,
                          input=scene_of(n_frames, held, **lists).encode())
    return numpy.frombuffer(done.stdout, 'float32').reshape(n_frames, ROWS, COLUMNS, 3).astype(
        float)


def check_forces(name):
    """Of what falls freely nothing in it matters."""
    fallen = run(name, 81)[-1] - FLAT
    near(fallen[..., 2].mean(), -0.5 * 9.81 * 0.16, 0.01, name + ': free fall')
    leaning = (run(name, 81, gravity_tilt__x=10.)[-1] - FLAT).mean(axis=(0, 1))
    near(leaning[0] / -leaning[2], math.tan(math.radians(10.)), 0.01, name + ': tilted gravity')
    # m g = c v
    slow = run(name, 200, air_drag_linear__coefficient=3.)
    near((slow[-1] - slow[-2])[..., 2].mean() * HZ, -0.15 * 9.81 / 3., 0.01,
         name + ': terminal speed')
    # What is heavy is slow to take up the wind: m a = rho C w^2/2.
    blown = run(name, 11, wind__y=2., wind__turbulence=0.01, gravity_scale__factor=0.,
                areal_density=15.)[-1] - FLAT
    near(blown[..., 1].mean(), 0.5 * 1.2 / 2. * 1.5 * 4. / 15. * 0.0025, 0.04, name + ': wind')
    # A sheet lies on a floor and gravity leans: a = g (sin - mu cos).
    level = LEVEL.ravel().tolist()
    for friction, pull in ((0.1, math.sin(0.2) - 0.1 * math.cos(0.2)), (0.4, 0.)):
        slid = run(name, 81, start=level, planes=[0., 0., 1., 0.], friction__coefficient=friction,
                   gravity_tilt__x=math.degrees(0.2))[-1] - LEVEL
        expect(abs(slid[..., 0].mean() - 0.5 * 9.81 * pull * 0.16) < 0.005,
               '%s: slides by %.4f m on a floor of %g' % (name, slid[..., 0].mean(), friction))
        expect(slid[..., 2].min() > -1e-3, name + ': not through it')


def check_material(name):
    """A strip that hangs from its upper edge: rho g H^2/2C longer (Green's strain at a point is
    the tension over C to first order); springs along diagonals take some of it."""
    top = range(COLUMNS)
    calm = {'damping__mass': 12., 'stretch__weft': 40., 'shear': 12.}
    longer = 0.15 * 9.81 * HEIGHT ** 2 / 2. / 40.
    hung = run(name, 300, top, **calm)[-1]
    near(-hung[-1, :, 2].mean() - HEIGHT, longer, 0.08, name + ': a strip that hangs')
    heavy = run(name, 300, top, areal_mass__log_ratio=math.log(2.), **calm)[-1]
    near(-heavy[-1, :, 2].mean() - HEIGHT, 2. * longer, 0.11, name + ': twice as heavy')
    stiff = run(name, 300, top, stretch__log_ratio=math.log(2.), **calm)[-1]
    near(-stiff[-1, :, 2].mean() - HEIGHT, longer / 2., 0.06, name + ': twice as stiff')
    short = run(name, 300, top, shrinkage__weft=0.05, **calm)[-1]
    near(hung[-1, :, 2].mean() - short[-1, :, 2].mean(), -0.05 * HEIGHT, 0.06,
         name + ': a shrunk strip')


def check_bending():
    """A cantilever, held by its first two rows, which makes it level: sag is the sum of
    q s^3 d/2B over the folds at a distance s from the end, d apart. Hinges zigzag besides, so
    that finite elements are softer."""
    d = HEIGHT / (ROWS - 1)
    truth = 0.15 * 0.981 * d ** 4 / 2. / 4e-3 * sum(k ** 3 for k in range(1, ROWS - 1))
    for name, share in (('fem', 0.3), ('xpbd', 0.04)):
        held = list(range(2 * COLUMNS))
        paths = numpy.tile(LEVEL.reshape(-1, 3)[held], (300, 1, 1))
        scene = dict(start=LEVEL.ravel().tolist(), paths=paths.ravel().tolist(),
                     damping__mass=12., bending__warp=4e-3, bending__weft=4e-3,
                     gravity_scale__factor=0.1)
        sunk = -run(name, 300, held, **scene)[-1, -1, :, 2].mean()
        near(sunk, truth, share, name + ': a cantilever')
        stiff = -run(name, 300, held, bending__log_ratio=math.log(2.), **scene)[-1, -1, :, 2].mean()
        near(stiff, sunk / 2., 0.03, name + ': one twice as stiff')


def check_refusals(name):
    whole = scene_of(3)
    for text, what in (('', 'nothing'), ('nonsense', 'no scene'),
                       (whole.replace('frames 2 3', 'frames 2 4').replace('held 0', 'held 1 0'),
                        'too few paths'), (whole[:400], 'half a scene')):
        done = subprocess.run([os.path.join(programs, name)], input=text.encode(),
                              capture_output=True, check=False)
        expect(done.returncode == 2 and b'scene: ' in done.stderr,
               '%s, %s: %s' % (name, what, done.stderr.decode().strip()))
    done = subprocess.run([os.path.join(programs, name)], capture_output=True, check=False,
                          input=scene_of(400, gravity_scale__factor=1e4).encode())
    expect(done.returncode == 1 and b'run away' in done.stderr, name + ': runs away')


for program in ('fem', 'xpbd', 'bullet'):
    if not os.path.exists(os.path.join(programs, program)):
        print('%s was not built: libbullet-dev is not installed' % program)
        continue
    check_forces(program)
    check_refusals(program)
    if program != 'bullet':
        check_material(program)
check_bending()
sys.exit(1 if faults else 0)
