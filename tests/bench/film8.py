#!/usr/bin/python3
"""Twenty seconds of eight cameras to a fitted cloth: a sheet with coloured dots hangs by two corners, which
a path moves for 500 frames; eight cameras of 1004 × 1004 pixels around it film it, which is not timed; the
dots are labelled, and the simulation is fitted. Asked: ten minutes on two cores.

  film8.py BUILD DATA      BUILD: the build; DATA: tests/data

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

import numpy

build, data = map(os.path.abspath, sys.argv[1:])
RIG, PATTERN = (os.path.join(data, 'dots_moving', name) for name in ('rig.json', 'pattern.json'))
FRAMES, FPS = 500, 25
# vertices of the cloth, which is wider than its dots; and of the dots
COLUMNS, ROWS, WIDTH, HEIGHT = 33, 35, 0.63, 0.67
DOTS, LINES, PITCH, MARGIN = 31, 33, 0.02, 0.015
CLOTH = {'version': 1, 'areal_density': 0.18, 'stretch': {'warp': 80, 'weft': 60}, 'shear': 12,
         'bending': {'warp': 3e-5, 'weft': 2e-5}, 'damping': {'mass': 0.8, 'stiffness': 0.001}}
GUESS = dict(CLOTH, stretch={'warp': 120, 'weft': 120}, shear=20,
             bending={'warp': 2e-5, 'weft': 3e-5}, damping={'mass': 0.4, 'stiffness': 0.001},
             free=[{'name': 'stretch.warp', 'range': [10, 1000]}, {'name': 'stretch.weft', 'range': [10, 1000]},
                   {'name': 'shear', 'range': [1, 300]}, {'name': 'damping.mass', 'range': [0.01, 20]}])


def write(path, what):
    with open(path, 'w', encoding='utf-8') as file:
        json.dump(what, file)
    return path


def write_take(folder, clamps, held, columns, rows, width, height):
    os.makedirs(folder + '/observations', exist_ok=True)
    numpy.save(folder + '/times.npy', numpy.arange(FRAMES) / FPS)
    numpy.save(folder + '/clamps.npy', clamps.astype('f4'))
    write(folder + '/take.json', {'version': 1, 'name': 'film', 'fps': FPS, 'held': [{'vertex': v} for v in held],
                                  'grid': {'columns': columns, 'rows': rows, 'width_m': width, 'height_m': height}})
    return folder


def run(what, *words):
    start = time.monotonic()
    subprocess.run(words, check=True)
    seconds = time.monotonic() - start
    print('%s: %.0f s' % (what, seconds), flush=True)
    return seconds


def path(start, phase):
    """Where a hand goes that holds a corner."""
    t = numpy.arange(FRAMES) / FPS
    share = numpy.minimum(t, 1)
    along = 0.03 * numpy.sin(2 * numpy.pi * 0.31 * t + phase) - 0.02 * numpy.sign(start[0])
    across = 0.08 * numpy.sin(2 * numpy.pi * (0.43 + 0.013 * t) * t + phase)
    up = 0.02 * numpy.sin(2 * numpy.pi * 0.57 * t + 2 * phase)
    return start + share[:, None] * numpy.stack([along, across, up], axis=1)


def at(cloth, u, v):
    """A place of the cloth over time, between its vertices."""
    x, y = u / WIDTH * (COLUMNS - 1), v / HEIGHT * (ROWS - 1)
    i, j = min(int(x), COLUMNS - 2), min(int(y), ROWS - 2)
    a, b = x - i, y - j
    return ((1 - b) * ((1 - a) * cloth[:, j, i] + a * cloth[:, j, i + 1])
            + b * ((1 - a) * cloth[:, j + 1, i] + a * cloth[:, j + 1, i + 1]))


def main(folder):
    tools = os.path.join(build, 'tools')
    u, v = numpy.meshgrid(numpy.linspace(0, WIDTH, COLUMNS), numpy.linspace(0, HEIGHT, ROWS))
    hung = numpy.stack([u - WIDTH / 2, numpy.full_like(u, 0.1), 1.15 - 0.999 * v], axis=2).reshape(-1, 3)
    scene = write_take(folder + '/scene', numpy.stack([path(hung[0], 0), path(hung[COLUMNS - 1], 0.6)], axis=1),
                       [0, COLUMNS - 1], COLUMNS, ROWS, WIDTH, HEIGHT)
    seen = numpy.full((FRAMES, COLUMNS * ROWS, 3), numpy.nan, 'f4')
    seen[0] = hung
    numpy.save(scene + '/positions.npy', seen)
    run('simulated', tools + '/gst-cloth-gap-1.0', 'simulate', write(folder + '/cloth.json', CLOTH), '--scene', scene,
        '--output', folder + '/cloth.take')
    cloth = numpy.load(folder + '/cloth.take/positions.npy').reshape(FRAMES, ROWS, COLUMNS, 3).astype(float)
    dots = numpy.stack([at(cloth, MARGIN + PITCH * i, MARGIN + PITCH * j) for j in range(LINES) for i in range(DOTS)],
                       axis=1)
    take = write_take(folder + '/film.take', dots[:, [0, DOTS - 1]], [0, DOTS - 1], DOTS, LINES,
                      PITCH * (DOTS - 1), PITCH * (LINES - 1))
    shutil.copy(RIG, take + '/rig.json')
    graph = []
    for k in range(8):
        film = '%s/cam%d.avi' % (folder, k)
        run('filmed by cam%d' % k, 'gst-launch-1.0', '-q', 'meshsrc', 'location=%s/cloth.take' % folder, '!',
            'clothcamera', 'rig=' + RIG, 'pattern=' + PATTERN, 'camera=cam%d' % k, 'sides=2', '!',
            'video/x-raw,format=I420', '!', 'jpegenc', 'quality=90', '!', 'avimux', '!', 'filesink',
            'location=' + film)
        graph += ['filesrc', 'location=' + film, '!', 'avidemux', '!', 'jpegdec', '!', 'videoconvert', '!',
                  'video/x-raw,format=I420', '!', 'dotlabel', 'pattern=' + PATTERN, 'camera=cam%d' % k, '!',
                  'clothmetapay', '!', 'filesink', 'location=%s/observations/cam%d.obs' % (take, k)]
    seconds = run('decoded and labelled', 'gst-launch-1.0', '-q', *graph)
    seconds += run('fitted', tools + '/gst-cloth-fit-1.0', 'fit', take, '--model',
                   write(folder + '/guess.json', GUESS), '--output', folder + '/fit')
    off = 1e3 * numpy.linalg.norm(numpy.load(folder + '/fit/take0/positions.npy') - dots, axis=2)
    print('%.1f min of the 10 asked; all dots in all frames, seen or not: %.2f mm off RMS, median %.2f'
          % (seconds / 60, numpy.sqrt((off ** 2).mean()), numpy.median(off)))


with tempfile.TemporaryDirectory() as made:
    main(made)
