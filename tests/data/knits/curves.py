#!/usr/bin/python3
"""Loading curves of knits for tests/core/simknits.c.

  curves.py FOLDER    reads FOLDER/<yarn>_<stitch>_<direction>.csv, writes curves.npy here

Each of five pulls up to its greatest force, as force over stretch: distance of the clamps
over their mean distance when pulls 2 to 5 begin. float32 [fabric][6][60]: stretch from
1.02 to the least of the greatest stretches less 0.5%, then the force of each pull there,
as recorded (newtons by the authors' gauge).

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import glob
import os
import sys

import numpy as np

curves = []
for path in sorted(glob.glob(os.path.join(sys.argv[1], '[AP]*.csv'))):
    rows = np.loadtxt(path, delimiter=',')
    pulls = []
    for number in range(1, 6):
        pull = rows[rows[:, 0] == number]
        pulls.append(pull[:pull[:, 4].argmax() + 1, [2, 4]])
    start = np.mean([pull[:5, 0].mean() for pull in pulls[1:]])
    end = min(pull[:, 0].max() for pull in pulls) / start
    stretch = np.linspace(1.02, 0.995 * end, 60)
    forces = []
    for pull in pulls:
        pull = pull[pull[:, 0].argsort()]
        forces.append(np.interp(stretch, pull[:, 0] / start, pull[:, 1]))
    print(os.path.basename(path))
    curves.append([stretch] + forces)
here = os.path.dirname(os.path.abspath(__file__))
np.save(os.path.join(here, 'curves.npy'), np.array(curves, np.float32))
