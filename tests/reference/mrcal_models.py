#!/usr/bin/python3
"""mrcal reads the .cameramodel files that we write, and sees points where we do.

  mrcal_models.py TOOL TEST_DATA       77: there is no mrcal

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import subprocess
import sys
import tempfile

try:
    import mrcal
    import numpy as np
except ImportError as missing:
    print('skipped:', missing)
    sys.exit(77)

tool, boards = sys.argv[1], os.path.join(sys.argv[2], 'opencv_boards')
models = [os.path.join(boards, side + '.cameramodel') for side in ('left', 'right')]
points = np.random.default_rng(1).uniform((-0.1, -0.1, 0.3), (0.1, 0.1, 2), (200, 3))


def seen(path, scene):
    model = mrcal.cameramodel(path)
    return mrcal.project(mrcal.transform_point_rt(model.extrinsics_rt_fromref(), scene), *model.intrinsics())


with tempfile.TemporaryDirectory() as folder:
    rig = os.path.join(folder, 'rig.json')
    subprocess.run([tool, *('--import-mrcal=' + path for path in models), '--output', rig, '--export-mrcal', folder],
                   check=True, stdout=subprocess.DEVNULL)
    for path in models:
        written = os.path.join(folder, os.path.basename(path))
        worst = np.abs(seen(path, points) - seen(written, points)).max()
        print(os.path.basename(path), 'within %.1e px' % worst)
        assert worst < 1e-6, worst
    # A calibration of ours: where OpenCV's formula has the points.
    subprocess.run([tool, '--pattern', os.path.join(boards, 'pattern.json'), '--output', rig, '--export-mrcal', folder,
                    *('%s=%s/%s*.jpg' % (side, boards, side) for side in ('left', 'right'))],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(rig, encoding='utf-8') as file:
        cameras = json.load(file)['cameras']
    # Before the cameras of a world whose z is up and y ahead.
    scene = points[:, [0, 2, 1]]
    for camera in cameras:
        local = scene @ np.array(camera['R']).T + camera['t']
        x, y = (local[:, :2] / local[:, 2:]).T
        k1, k2, p1, p2, k3 = camera['distortion']['coefficients']
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        K = np.array(camera['K'])
        u = K[0, 0] * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + K[0, 2]
        v = K[1, 1] * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + K[1, 2]
        worst = np.abs(seen(os.path.join(folder, camera['name'] + '.cameramodel'), scene) - np.array([u, v]).T).max()
        print(camera['name'], 'within %.1e px' % worst)
        assert worst < 1e-4, worst
