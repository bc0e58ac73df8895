#!/usr/bin/python3
"""Prints how far a captured pattern lies from the true surface of the cloth.

  compare-truth.py TAKE --truth vertices.npy --grid COLUMNSxROWS --pattern pattern.json

TAKE is a folder with positions.npy (and covariance.npy, when there is one). The truth
is float32 [frames][rows*columns][3], the surface between its vertices bilinear. The
limits --max-rms-mm and --min-seen make the exit code 1 when they are not kept.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import argparse
import json
import os
import sys

import numpy

# States of vertices that three or more cameras saw, and two.
MEASURED = (1, 2)


def pitch_of(pattern):
    """Distances of neighbouring vertices, m: in a row and in a column."""
    if pattern['pattern'] == 'picture':
        return [pattern['cloth_m'][0] / (pattern['columns'] - 1),
                pattern['cloth_m'][1] / (pattern['rows'] - 1)]
    return 2 * [pattern['pitch_m' if pattern['pattern'] == 'm-array' else 'square_m']]


def true_corners(truth, columns, rows, pattern):
    """[frames][vertices][3]: where each corner of a board, dot of an M-array, vertex of a picture is."""
    outer = pattern['pattern'] == 'checker'
    origin = pattern.get('origin_uv_m', [0, 0])
    pitch = pitch_of(pattern)
    frames = truth.shape[0]
    grid = truth.reshape(frames, rows, columns, 3).astype(float)
    across, down = numpy.meshgrid(numpy.arange(pattern['columns'] + outer),
                                  numpy.arange(pattern['rows'] + outer))
    u = origin[0] + across.ravel() * pitch[0]
    v = origin[1] + down.ravel() * pitch[1]
    x = u / pattern['cloth_m'][0] * (columns - 1)
    y = v / pattern['cloth_m'][1] * (rows - 1)
    left = numpy.clip(x.astype(int), 0, columns - 2)
    top = numpy.clip(y.astype(int), 0, rows - 2)
    a, b = (x - left)[:, None], (y - top)[:, None]
    return ((1 - b) * ((1 - a) * grid[:, top, left] + a * grid[:, top, left + 1])
            + b * ((1 - a) * grid[:, top + 1, left] + a * grid[:, top + 1, left + 1]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('take', help='folder with positions.npy')
    parser.add_argument('--truth', required=True)
    parser.add_argument('--grid', required=True, help='of the truth, COLUMNSxROWS')
    parser.add_argument('--pattern', required=True)
    parser.add_argument('--max-rms-mm', type=float)
    parser.add_argument('--min-seen', type=float, help='share of the vertices, 0 to 1')
    options = parser.parse_args()

    with open(options.pattern, encoding='utf-8') as file:
        pattern = json.load(file)
    columns, rows = (int(n) for n in options.grid.split('x'))
    truth = numpy.load(options.truth)
    found = numpy.load(os.path.join(options.take, 'positions.npy')).astype(float)
    corners = true_corners(truth, columns, rows, pattern)
    if found.ndim != 3 or found.shape[1:] != corners.shape[1:] or len(found) > len(corners):
        sys.exit('%s: positions.npy is %s, the truth gives %s'
                 % (options.take, found.shape, corners.shape))

    error = (found - corners[:len(found)]) * 1000
    seen = numpy.isfinite(error).all(axis=2)
    if not seen.any():
        sys.exit('%s: no vertex was seen' % options.take)
    distance = numpy.linalg.norm(error[seen], axis=1)
    rms = numpy.sqrt((distance ** 2).mean())
    axes = numpy.sqrt((error[seen] ** 2).mean(axis=0))
    share = seen.sum() / (len(corners) * corners.shape[1])

    table = [
        ('frames', '%d of %d' % (len(found), len(corners))),
        ('vertices located', '%d of %d (%.1f%%)'
         % (seen.sum(), len(corners) * corners.shape[1], 100 * share)),
        ('error, RMS', '%.3f mm' % rms),
        ('error, RMS along x, y, z', '%.3f, %.3f, %.3f mm' % tuple(axes)),
        ('error, median', '%.3f mm' % numpy.median(distance)),
        ('error, 95th percentile', '%.3f mm' % numpy.percentile(distance, 95)),
        ('error, largest', '%.3f mm' % distance.max()),
    ]
    covariance = os.path.join(options.take, 'covariance.npy')
    if os.path.exists(covariance):
        sigma = numpy.load(covariance)[seen][:, [0, 3, 5]].astype(float).sum(axis=1)
        predicted = 1000 * numpy.sqrt(sigma[numpy.isfinite(sigma)].mean())
        table.append(('error, RMS predicted', '%.3f mm (true / predicted = %.2f)'
                      % (predicted, rms / predicted)))
    # What was filled in was seen by nobody, so it is mistaken for nothing.
    measured = numpy.ones(len(distance), bool)
    states = os.path.join(options.take, 'states.npy')
    if os.path.exists(states):
        measured = numpy.isin(numpy.load(states)[seen], MEASURED)
    for name, which in (('measured', measured), ('filled, predicted', ~measured)):
        if which.any() and not measured.all():
            table.append(('error of %d %s' % (which.sum(), name),
                          '%.3f mm RMS, largest %.3f mm'
                          % (numpy.sqrt((distance[which] ** 2).mean()), distance[which].max())))
    # Half a square off is no noise: a corner was taken for another one.
    wrong = (distance[measured] > 500 * min(pitch_of(pattern))).sum()
    table.append(('corners mistaken for others', '%d' % wrong))
    width = max(len(name) for name, _ in table)
    for name, value in table:
        print('  %-*s  %s' % (width, name, value))

    kept = options.max_rms_mm is None or wrong == 0
    if options.max_rms_mm is not None and rms > options.max_rms_mm:
        print('the RMS error is above %g mm' % options.max_rms_mm)
        kept = False
    if options.min_seen is not None and share < options.min_seen:
        print('fewer than %g%% of the corners were located' % (100 * options.min_seen))
        kept = False
    return 0 if kept else 1


if __name__ == '__main__':
    sys.exit(main())
