#!/usr/bin/python3
"""What tests/core/simtakes.c compares: low modes and edge speeds of takes.

  modes.py TAKES     reads TAKES/<name>/positions.npy, writes modes.npy and speeds.npy here

A mode is the product of two Legendre polynomials of degree 0 to 3, in u and in v, each
scaled to a mean square of 1 on [-1, 1]: 16 of them, the degree in u runs first. Each frame
is fitted by least squares at the vertices that were seen. A speed is the mean over the
vertices of the lowest row of |x(t + h) - x(t - h)| / 2h, h one frame; NaN at the ends.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import sys

import numpy as np

NAMES = ('base_arcsim', 't14', 't68', 'base_blender', 't55', 't75')
COLUMNS, ROWS, FPS = 33, 35, 50


def legendre(n):
    at = np.linspace(-1, 1, n)
    return [np.polynomial.legendre.legval(at, np.eye(4)[k]) * np.sqrt(2 * k + 1)
            for k in range(4)]


def main():
    u, v = legendre(COLUMNS), legendre(ROWS)
    basis = np.stack([np.outer(v[j], u[i]).ravel() for j in range(4) for i in range(4)], 1)
    modes, speeds = [], []
    for name in NAMES:
        x = np.load(os.path.join(sys.argv[1], name, 'positions.npy')).astype(float)
        fits = []
        for frame in x:
            seen = np.isfinite(frame[:, 0])
            fits.append(np.linalg.lstsq(basis[seen], frame[seen], rcond=None)[0])
        modes.append(fits)
        edge = x.reshape(-1, ROWS, COLUMNS, 3)[:, -1]
        speed = np.full(len(x), np.nan)
        speed[1:-1] = np.nanmean(
            np.linalg.norm(edge[2:] - edge[:-2], axis=-1), axis=1) * FPS / 2
        speeds.append(speed)
    here = os.path.dirname(os.path.abspath(__file__))
    np.save(os.path.join(here, 'modes.npy'), np.array(modes, np.float32))
    np.save(os.path.join(here, 'speeds.npy'), np.array(speeds, np.float32))


main()
