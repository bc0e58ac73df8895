#!/usr/bin/python3
"""What mrcal says of the shipped boards: mrcal.txt, left.cameramodel and right.cameramodel in
tests/data/opencv_boards.

  mrcal_boards.py TEST_DATA            writes the files
  mrcal_boards.py --check TEST_DATA    whether mrcal still says the same; 77: there is no mrcal

Each camera alone, then both together, from the corners of corners_cv2.txt, every corner of
one weight, without regularisation and outlier rejection, which we have in another form. mrcal's
standard deviations are of the scatter of the residuals, not divided by the degrees of freedom.
SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import sys

try:
    import mrcal
    import numpy as np
except ImportError as missing:
    print('skipped:', missing)
    sys.exit(77)

check = sys.argv[1] == '--check'
boards = os.path.join(sys.argv[-1], 'opencv_boards')
ROWS, COLUMNS, SQUARE = 6, 9, 0.025
SIZE = (640, 480)
SEED = np.array([535, 535, 319.5, 239.5])


def optimised(sides, bent=False):
    table = np.loadtxt(os.path.join(boards, 'corners_cv2.txt'))
    frames = 1 + int(table[:, 1].max())
    corners = np.ones((len(sides), frames, ROWS, COLUMNS, 3))
    for side, frame, vertex, x, y in table:
        if side in sides:
            corners[sides.index(side), int(frame), int(vertex) // COLUMNS, int(vertex) % COLUMNS, :2] = x, y
    pinhole = mrcal.cameramodel(intrinsics=('LENSMODEL_PINHOLE', SEED), imagersize=SIZE)
    seen = np.array([[frame, camera] for frame in range(frames) for camera in range(len(sides))], dtype=np.int32)
    poses = [mrcal.estimate_monocular_calobject_poses_Rt_tocam(
        np.array([[frame, 0] for frame in range(frames)], dtype=np.int32), corners[camera], SQUARE, [pinhole])
        for camera in range(len(sides))]
    # From the second camera to the first, as the first frame says.
    extrinsics = [mrcal.rt_from_Rt(mrcal.compose_Rt(poses[camera][0], mrcal.invert_Rt(poses[0][0])))
                  for camera in range(1, len(sides))]
    intrinsics = np.zeros((len(sides), 9))
    intrinsics[:, :4] = SEED
    inputs = dict(
        lensmodel='LENSMODEL_OPENCV5', intrinsics=intrinsics,
        extrinsics_rt_fromref=np.array(extrinsics).reshape(-1, 6), frames_rt_toref=mrcal.rt_from_Rt(poses[0]),
        points=None, observations_board=np.ascontiguousarray(np.array([corners[c, f] for f, c in seen])),
        indices_frame_camintrinsics_camextrinsics=np.array([[f, c, c - 1] for f, c in seen], dtype=np.int32),
        observations_point=None, indices_point_camintrinsics_camextrinsics=None,
        calobject_warp=np.zeros(2) if bent else None,
        imagersizes=np.array([SIZE] * len(sides), dtype=np.int32), calibration_object_spacing=SQUARE,
        do_optimize_intrinsics_core=True, do_optimize_intrinsics_distortions=True, do_optimize_extrinsics=True,
        do_optimize_frames=True, do_optimize_calobject_warp=bent, do_apply_regularization=False,
        do_apply_outlier_rejection=False, verbose=False)
    for _ in range(3):
        mrcal.optimize(**inputs)
    return inputs


def distance(model, inputs):
    """Of the boards' corners from the camera, on average."""
    flat = SQUARE * np.array([[column, row, 0] for row in range(ROWS) for column in range(COLUMNS)])
    points = mrcal.transform_point_rt(inputs['frames_rt_toref'][:, np.newaxis], flat)
    return float(np.linalg.norm(mrcal.transform_point_rt(model.extrinsics_rt_fromref(), points), axis=-1).mean())


def deviations(inputs, n_cameras):
    """1σ of the intrinsics of each camera: of the scatter of the residuals, through (JᵀJ)⁻¹."""
    _, x, jacobian, _ = mrcal.optimizer_callback(**inputs)
    J = jacobian.toarray()
    scale = np.ones(J.shape[1])
    mrcal.unpack_state(scale, **inputs)
    sigma = np.sqrt(np.diag(np.linalg.inv(J.T @ J)) * np.mean(x ** 2)) * scale
    return [sigma[at:at + 9] for at in (mrcal.state_index_intrinsics(camera, **inputs) for camera in range(n_cameras))]


lines = ['# made by tests/reference/mrcal_boards.py with mrcal 2.2 of Debian 12',
         '# cameras in the fit, camera: fx fy cx cy k1 k2 p1 p2 k3, distance (m)',
         '# bent: the same parameters where the board may be, its warp (m), 1σ in the centre, at infinity (px)',
         '# sd: 1σ of fx fy cx cy k1 k2 p1 p2 k3',
         '# cameras in the fit, camera, x, y: 1σ in the worst direction (px) at that distance, at infinity']
for sides in ([0], [1], [0, 1]):
    inputs = optimised(sides)
    for camera, side in enumerate(sides):
        model = mrcal.cameramodel(optimization_inputs=inputs, icam_intrinsics=camera)
        away = distance(model, inputs)
        if not check and len(sides) == 2:
            model.write(os.path.join(boards, ('left', 'right')[side] + '.cameramodel'))
        lines.append('lens %d %d ' % (len(sides), side)
                     + ' '.join('%.9g' % value for value in (*model.intrinsics()[1], away)))
        lines.append('sd %d %d ' % (len(sides), side)
                     + ' '.join('%.5g' % value for value in deviations(inputs, len(sides))[camera]))
        pixels = np.array([[(SIZE[0] - 1) * i / 4, (SIZE[1] - 1) * j / 4] for j in range(5) for i in range(5)])
        rays = mrcal.unproject(pixels, *model.intrinsics(), normalize=True)
        near = mrcal.projection_uncertainty(rays * away, model, what='worstdirection-stdev')
        far = mrcal.projection_uncertainty(rays, model, what='worstdirection-stdev', atinfinity=True)
        for pixel, a, b in zip(pixels, near, far):
            lines.append('px %d %d %g %g %.5g %.5g' % (len(sides), side, *pixel, a, b))
    inputs = optimised(sides, True)
    for camera, side in enumerate(sides):
        model = mrcal.cameramodel(optimization_inputs=inputs, icam_intrinsics=camera)
        ray = mrcal.unproject(np.array([(SIZE[0] - 1) / 2, (SIZE[1] - 1) / 2]), *model.intrinsics(), normalize=True)
        far = mrcal.projection_uncertainty(ray, model, what='worstdirection-stdev', atinfinity=True)
        lines.append('bent %d %d ' % (len(sides), side) + ' '.join(
            '%.9g' % value for value in (*model.intrinsics()[1], *inputs['calobject_warp'], far)))
text = '\n'.join(lines) + '\n'
path = os.path.join(boards, 'mrcal.txt')
if not check:
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
else:
    with open(path, encoding='utf-8') as file:
        kept = file.read()
    numbers = [[float(word) for word in line.split()[1:]] for line in text.splitlines() if line[0] != '#']
    before = [[float(word) for word in line.split()[1:]] for line in kept.splitlines() if line[0] != '#']
    worst = max(abs(a / b - 1) for x, y in zip(numbers, before) for a, b in zip(x, y) if b)
    print('mrcal: %d lines, all numbers within %.1e of the kept ones' % (len(numbers), worst))
    sys.exit(0 if len(numbers) == len(before) and worst < 1e-3 else 1)
