#!/usr/bin/python3
"""Films a printed cloth with eight cameras from all around, matches each film with the flat
print, triangulates, and holds the vertices against the truth: where they are, and whether their
covariances say how far they are off. Twice: a cloth that is bent smoothly, and one that has a
crease along every line of its grid, which no cloth has.

  film-print.py DATA [FRAMES TRUTH]

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

import numpy

data = os.path.abspath(sys.argv[1])
TRUTH = sys.argv[3] if len(sys.argv) > 3 else os.path.join(data, 'dots_ring8/vertices.npy')
N_FRAMES = int(sys.argv[2]) if len(sys.argv) > 2 else 1
RIG = os.path.join(data, 'dots_ring8/rig8.json')
PRINT = os.path.join(data, 'lineart_stereo3')
COLUMNS, ROWS, WIDTH, HEIGHT = 33, 35, 0.63, 0.67
# Faces between two vertices.
FINE = 6
# The films' own blur and noise, in every camera.
PICTURE = 'defocus,sigma=0.5; noise,sigma=2'
faults = []


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what), flush=True)
    if not true:
        faults.append(what)


def spline(points, axis):
    """Points of the natural cubic spline through those along an axis, FINE for each."""
    y = numpy.moveaxis(points, axis, 0)
    n = len(y)
    system = 4 * numpy.eye(n)
    system[0, 0] = system[-1, -1] = 1
    for i in range(1, n - 1):
        system[i, i - 1] = system[i, i + 1] = 1
    bend = numpy.zeros_like(y)
    bend[1:-1] = 6 * (y[2:] + y[:-2] - 2 * y[1:-1])
    bend = numpy.linalg.solve(system, bend.reshape(n, -1)).reshape(y.shape)
    fine = []
    for i in range(n - 1):
        for k in range(FINE):
            t = k / FINE
            s = 1 - t
            fine.append(s * y[i] + t * y[i + 1]
                        + ((s**3 - s) * bend[i] + (t**3 - t) * bend[i + 1]) / 6)
    return numpy.moveaxis(numpy.array(fine + [y[-1]]), 0, axis)


def film(truth, folder):
    """Positions and covariances out of eight films of a cloth whose vertices are given."""
    frames, rows, columns, _ = truth.shape
    os.makedirs(os.path.join(folder, 'cloth'))
    numpy.save(os.path.join(folder, 'cloth/positions.npy'),
               truth.reshape(frames, -1, 3).astype('f4'))
    with open(os.path.join(folder, 'cloth/take.json'), 'w', encoding='utf-8') as file:
        json.dump({'version': 1, 'name': 'cloth', 'fps': 25, 'held': [], 'noise_sigma_m': None,
                   'grid': {'columns': columns, 'rows': rows, 'width_m': WIDTH,
                            'height_m': HEIGHT}}, file)
    graph = ['triangulate', 'name=join', 'rig=' + RIG, 'pattern=%s/pattern.json' % PRINT,
             '!', 'meshsink', 'location=%s/found' % folder, 'format=take',
             'meshsrc', 'location=%s/cloth' % folder, '!', 'tee', 'name=cloth']
    for k in range(8):
        graph += ['cloth.', '!', 'queue', '!', 'clothcamera', 'rig=' + RIG, 'camera=cam%d' % k,
                  'texture=%s/reference.png' % PRINT, 'sides=2', 'effects=' + PICTURE,
                  'seed=%d' % k, '!', 'video/x-raw,format=GRAY8', '!', 'siftmatch',
                  'pattern=%s/pattern.json' % PRINT, 'camera=cam%d' % k, '!', 'queue', '!', 'join.']
    subprocess.run(['gst-launch-1.0', '-q'] + graph, check=True)
    return [numpy.load(os.path.join(folder, 'found', name)).astype(float)
            for name in ('positions.npy', 'covariance.npy')]


def judge(name, truth, most_rms, most_ratio):
    folder = tempfile.mkdtemp()
    try:
        vertices = truth[:, ::FINE, ::FINE] if name == 'smooth' else truth
        positions, packed = film(truth, folder)
        error = positions - vertices.reshape(positions.shape)
        seen = numpy.isfinite(error).all(axis=2)
        covariance = numpy.zeros(error.shape + (3,))
        for k, (i, j) in enumerate(((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))):
            covariance[..., i, j] = covariance[..., j, i] = packed[..., k]
        e, c = error[seen], covariance[seen]
        distance = 1e3 * numpy.linalg.norm(e, axis=1)
        chi2 = numpy.einsum('ni,ni->n', e, numpy.linalg.solve(c, e[..., None])[..., 0])
        rms = numpy.sqrt(numpy.mean(distance**2))
        # 2.366 is the median of χ² of three numbers
        ratio = numpy.median(chi2) / 2.366
        print('%s: seen %.1f%%, RMS %.3f mm, median %.3f mm, 95%% within %.3f mm, χ²/3 %.2f, '
              'median of χ² over what it should be %.2f'
              % (name, 100 * seen.mean(), rms, numpy.median(distance),
                 numpy.quantile(distance, .95), chi2.mean() / 3, ratio), flush=True)
        expect(seen.mean() > 0.93, 'vertices are seen')
        expect(rms < most_rms, 'they are where the truth is')
        expect(0.5 < ratio < most_ratio, 'covariances say so')
    finally:
        shutil.rmtree(folder)


def main():
    creased = numpy.load(TRUTH)[:N_FRAMES].astype(float).reshape(-1, ROWS, COLUMNS, 3)
    judge('smooth', spline(spline(creased, 1), 2), 0.6, 1.5)
    judge('creased', creased, 1, 3)
    sys.exit(bool(faults))


main()
