#!/usr/bin/python3
"""A cloth of masses and springs by numpy, with names and units of its own, behind the contract of
docs/own-simulator.md: a user's simulator that shares nothing with the project's.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import shutil
import sys

import numpy

# The drag's force on an area is drag |v|v, without ½ρ: with ρ = 1.2 kg/m³, C is 1.67 times that.
PARAMETERS = [
    ('tension', 'N/m', 15, [2, 40], ['stretch.warp', 'stretch.weft'], 1),
    ('diagonal', 'N/m', 5, [0.5, 30], 'shear', None),
    ('folding', 'N/m', 0.1, [0.005, 2], ['bending.warp', 'bending.weft'], None),
    ('weight', 'g/m²', 150, [40, 600], 'areal_density', 1e-3),
    ('drag', 'kg/m³', 0, [0, 6], 'effects.air_drag.coefficient', 1.67),
    ('loss', '1/s', 0.3, [0, 5], 'damping.mass', 1),
    ('steps', '1', 80, None, None, None),
]


def link(columns, rows, flat, p):
    """Pairs of vertices, how long they are and how stiff."""
    index = numpy.arange(columns * rows).reshape(rows, columns)
    a, b, k = [], [], []
    for x, y, name in ((1, 0, 'tension'), (0, 1, 'tension'), (1, 1, 'diagonal'),
                       (-1, 1, 'diagonal')):
        first = index[:rows - y, max(0, -x):columns - max(0, x)]
        a.append(first.ravel())
        b.append(index[y:, max(0, x):columns + min(0, x)].ravel())
        k.append(numpy.full(first.size, float(p[name])))
    a, b, k = (numpy.concatenate(part) for part in (a, b, k))
    return a, b, numpy.linalg.norm(flat[a] - flat[b], axis=1), k


def find_areas(x, columns, rows):
    """Of each vertex, along its normal."""
    grid = x.reshape(rows, columns, 3)
    cross = numpy.cross(grid[1:, 1:] - grid[:-1, :-1], grid[1:, :-1] - grid[:-1, 1:]) / 8.
    area = numpy.zeros_like(grid)
    for part in (area[1:, 1:], area[:-1, 1:], area[1:, :-1], area[:-1, :-1]):
        part += cross
    return area.reshape(-1, 3)


def find_force(x, v, shape, springs, p):
    columns, rows = shape
    a, b, rest, k = springs
    along = x[b] - x[a]
    pull = (k * (1. - rest / numpy.linalg.norm(along, axis=1)))[:, None] * along
    force = numpy.stack([numpy.bincount(a, part, len(x)) - numpy.bincount(b, part, len(x))
                         for part in pull.T], axis=1)
    sheet, fold = x.reshape(rows, columns, 3), force.reshape(rows, columns, 3)
    for to, line in ((fold, sheet), (fold.transpose(1, 0, 2), sheet.transpose(1, 0, 2))):
        curve = p['folding'] * (line[2:] - 2. * line[1:-1] + line[:-2])
        to[2:] -= curve
        to[1:-1] += 2. * curve
        to[:-2] -= curve
    area = find_areas(x, columns, rows)
    speed = (v * area).sum(axis=1, keepdims=True) / (
        numpy.linalg.norm(area, axis=1, keepdims=True) + 1e-12)
    return force - p['drag'] * numpy.abs(speed) * speed * area


def simulate(folder):
    with open(folder + '/scene/take.json', encoding='utf-8') as file:
        take = json.load(file)
    with open(folder + '/parameters.json', encoding='utf-8') as file:
        p = dict({row[0]: row[2] for row in PARAMETERS}, **json.load(file))
    times = numpy.load(folder + '/scene/times.npy')
    clamps = numpy.load(folder + '/scene/clamps.npy').astype(float)
    positions = numpy.load(folder + '/scene/positions.npy')
    grid, held = take['grid'], [held['vertex'] for held in take['held']]
    shape = grid['columns'], grid['rows']
    v, u = numpy.divmod(numpy.arange(shape[0] * shape[1]), shape[0])
    flat = numpy.stack([u * grid['width_m'] / (shape[0] - 1),
                        v * grid['height_m'] / (shape[1] - 1), 0. * u], axis=1)
    springs = link(*shape, flat, p)
    mass = 1e-3 * p['weight'] * numpy.abs(find_areas(flat, *shape)[:, 2:])
    x, v = positions[0].astype(float), numpy.zeros(flat.shape)
    for frame in range(1, len(times)):
        dt = (times[frame] - times[frame - 1]) / p['steps']
        for step in range(int(p['steps'])):
            force = find_force(x, v, shape, springs, p)
            v = (v + dt * (force / mass + [0., 0., -9.81])) * (1. - p['loss'] * dt)
            x = x + dt * v
            at = (step + 1.) / p['steps']
            x[held] = clamps[frame - 1] * (1. - at) + clamps[frame] * at
            v[held] = (clamps[frame] - clamps[frame - 1]) / (times[frame] - times[frame - 1])
        positions[frame] = x
    shutil.copytree(folder + '/scene', folder + '/simulated', dirs_exist_ok=True)
    if os.path.exists(folder + '/simulated/states.npy'):
        os.remove(folder + '/simulated/states.npy')
    numpy.save(folder + '/simulated/positions.npy', positions.astype(numpy.float32))


def main(argument):
    if argument == '--capabilities':
        keys = ('name', 'unit', 'value', 'range', 'is', 'scale')
        json.dump({'version': 1, 'simulator': 'springs', 'parameters': [
            dict(zip(keys, row)) for row in PARAMETERS]}, sys.stdout)
    else:
        simulate(argument)


if __name__ == '__main__':
    main(sys.argv[1])
