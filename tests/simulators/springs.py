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


def both(rows, columns):
    """Of each kind of springs the vertices at their two ends, as parts of the grid."""
    for x, y, name in ((1, 0, 'tension'), (0, 1, 'tension'), (1, 1, 'diagonal'),
                       (-1, 1, 'diagonal')):
        yield ((slice(0, rows - y), slice(max(0, -x), columns - max(0, x))),
               (slice(y, rows), slice(max(0, x), columns + min(0, x))), name)


class Sheet:
    """Forces of a grid, [3][rows][columns], in few calls of numpy."""

    def __init__(self, flat, p):
        shape = flat.shape[1:]
        index = numpy.arange(shape[0] * shape[1]).reshape(shape)
        self.ends = list(both(*shape))
        self.a, self.b = (numpy.concatenate([index[end[k]].ravel() for end in self.ends])
                          for k in (0, 1))
        self.k = numpy.concatenate([numpy.full(index[end[0]].size, float(p[end[2]]))
                                    for end in self.ends])
        ends = numpy.cumsum([0] + [index[end[0]].size for end in self.ends])
        self.parts = [slice(*part) for part in zip(ends[:-1], ends[1:])]
        self.rest = numpy.sqrt((self.find_along(flat) ** 2).sum(axis=0))
        n = numpy.eye(index.size)
        fold = numpy.concatenate([
            (n[line[2:]] - 2. * n[line[1:-1]] + n[line[:-2]]).reshape(-1, index.size)
            for line in (index, index.T)])
        self.folding, self.drag = -p['folding'] * fold.T @ fold, p['drag']

    def find_along(self, x):
        x = x.reshape(3, -1)
        return x.take(self.b, 1) - x.take(self.a, 1)

    def find_areas(self, x):
        """Of each vertex, along its normal."""
        a, b = x[:, 1:, 1:] - x[:, :-1, :-1], x[:, 1:, :-1] - x[:, :-1, 1:]
        cross = numpy.empty_like(a)
        for k in range(3):
            cross[k] = 0.125 * (a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2])
        area = numpy.zeros_like(x)
        for part in (area[:, 1:, 1:], area[:, :-1, 1:], area[:, 1:, :-1], area[:, :-1, :-1]):
            part += cross
        return area

    def find_force(self, x, v):
        along = self.find_along(x)
        along *= self.k * (1. - self.rest / numpy.sqrt(numpy.einsum('ij,ij->j', along, along)))
        force = (x.reshape(3, -1) @ self.folding).reshape(x.shape)
        for (a, b, _), part in zip(self.ends, self.parts):
            to = force[:, a[0], a[1]]
            pull = along[:, part].reshape(to.shape)
            to += pull
            force[:, b[0], b[1]] -= pull
        if not self.drag:
            return force
        area = self.find_areas(x)
        speed = numpy.einsum('ijk,ijk->jk', v, area) / (
            numpy.sqrt(numpy.einsum('ijk,ijk->jk', area, area)) + 1e-12)
        return force - self.drag * numpy.abs(speed) * speed * area


def simulate(folder):
    with open(folder + '/scene/take.json', encoding='utf-8') as file:
        take = json.load(file)
    with open(folder + '/parameters.json', encoding='utf-8') as file:
        p = dict({row[0]: row[2] for row in PARAMETERS}, **json.load(file))
    times = numpy.load(folder + '/scene/times.npy')
    clamps = numpy.load(folder + '/scene/clamps.npy').astype(float)
    positions = numpy.load(folder + '/scene/positions.npy')
    grid, held = take['grid'], [held['vertex'] for held in take['held']]
    rows, columns = grid['rows'], grid['columns']
    row, column = numpy.divmod(numpy.array(held), columns)
    flat = numpy.zeros((3, rows, columns))
    flat[0] = numpy.arange(columns) * grid['width_m'] / (columns - 1)
    flat[1] = numpy.arange(rows)[:, None] * grid['height_m'] / (rows - 1)
    sheet = Sheet(flat, p)
    of_mass = 1. / (1e-3 * p['weight'] * numpy.abs(sheet.find_areas(flat)[2]))
    x, v = positions[0].astype(float).T.reshape(flat.shape).copy(), numpy.zeros(flat.shape)
    weight = numpy.array([0., 0., -9.81])[:, None, None]
    for frame in range(1, len(times)):
        dt = (times[frame] - times[frame - 1]) / p['steps']
        for step in range(int(p['steps'])):
            v += dt * (sheet.find_force(x, v) * of_mass + weight)
            v *= 1. - p['loss'] * dt
            x += dt * v
            at = (step + 1.) / p['steps']
            x[:, row, column] = (clamps[frame - 1] * (1. - at) + clamps[frame] * at).T
            v[:, row, column] = ((clamps[frame] - clamps[frame - 1]) /
                                 (times[frame] - times[frame - 1])).T
        positions[frame] = x.reshape(3, -1).T
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
