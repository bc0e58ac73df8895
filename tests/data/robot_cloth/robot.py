#!/usr/bin/python3
"""Made cloth.csv and gripper.csv beside it of the take in tests/data/take_drag, as a robot's lab
would have them: millimetres, y up, times of the computer's clock, markers numbered from 1, some of
them hidden for a while; the gripper's two fingers in a log of their own, twice as often.

  robot.py TAKE FOLDER

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import sys

import numpy

take, folder = sys.argv[1:]
positions = numpy.load(os.path.join(take, 'positions.npy')).astype(float)
clamps = numpy.load(os.path.join(take, 'clamps.npy')).astype(float)
START = 1760000000.0


def turned(places):
    """y up, in millimetres."""
    return 1000 * numpy.stack((places[..., 0], places[..., 2], -places[..., 1]), -1)


def row(when, places):
    return '%.3f,%s\n' % (when, ','.join('' if numpy.isnan(x) else '%.1f' % x
                                         for x in turned(places).ravel()))


# an arm before the cloth
for frame in range(20, 32):
    for line in range(4, 7):
        positions[frame, 9 * line + (frame - 20) // 2: 9 * line + (frame - 20) // 2 + 3] = numpy.nan
with open(os.path.join(folder, 'cloth.csv'), 'w', encoding='ascii') as file:
    file.write('stamp_s,' + ','.join('m%d_%s' % (k + 1, axis) for k in range(positions.shape[1])
                                     for axis in 'xyz') + '\n')
    for i, places in enumerate(positions):
        file.write(row(START + i / 50, places))
with open(os.path.join(folder, 'gripper.csv'), 'w', encoding='ascii') as file:
    file.write('stamp_s,' + ','.join('%s_%s' % (finger, axis) for finger in ('left', 'right')
                                     for axis in 'xyz') + '\n')
    for i in range(-2, 2 * len(clamps) + 2):
        at = numpy.clip(i / 2, 0, len(clamps) - 1)
        places = [[numpy.interp(at, range(len(clamps)), clamps[:, k, axis]) for axis in range(3)]
                  for k in range(2)]
        file.write(row(START + i / 100, numpy.array(places)))
