#!/usr/bin/python3
"""gst-cloth-calibrate-1.0 and ChArUco boards, drawn by OpenCV through a known camera: found in part
and upside down, calibrated to the truth, beside OpenCV's own calibration of the same pictures.

  charuco.py TOOL
  charuco.py --write FOLDER     some of the pictures, as tests/data/charuco has them

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import re
import subprocess
import sys
import tempfile

import cv2
import numpy as np

tool, keep = (sys.argv[1], None) if len(sys.argv) == 2 else (None, sys.argv[2])
aruco = cv2.aruco
SIZE, FINE = (640, 480), 3
K = np.array([[610.0, 0, 331], [0, 605, 236], [0, 0, 1]])
LENS = np.array([-0.21, 0.09, 0.0008, -0.0006, 0])
SQUARE, MARKER = 0.03, 0.022
N = 14
failed = 0


def check(good, what):
    global failed
    print(('ok: ' if good else 'not ok: ') + what)
    failed += not good


def run(*arguments):
    return subprocess.run([tool, *arguments], capture_output=True, text=True, timeout=120, check=False)


def make_board(columns, rows, name):
    dictionary = aruco.getPredefinedDictionary(getattr(aruco, 'DICT_' + name.upper().replace('DICT_', '')))
    return aruco.CharucoBoard_create(columns, rows, SQUARE, MARKER, dictionary), dictionary


def draw(folder, board, columns, rows, name, seed):
    """N pictures of a board as the camera sees it; some of only a part of it."""
    rng = np.random.default_rng(seed)
    per = 160
    flat = draw_flat(board, columns, rows, per)
    u, v = np.meshgrid((np.arange(SIZE[0] * FINE) + 0.5) / FINE - 0.5,
                       (np.arange(SIZE[1] * FINE) + 0.5) / FINE - 0.5)
    rays = cv2.undistortPoints(np.stack([u.ravel(), v.ravel()], 1)[:, None], K, LENS)[:, 0]
    rays = np.concatenate([rays, np.ones((len(rays), 1))], 1)
    pictures = []
    for i in range(N):
        turn = rng.uniform(-0.6, 0.6, 3)
        turn[2] = np.pi if i == 3 else rng.uniform(-0.4, 0.4)
        R = cv2.Rodrigues(np.array([0, 0, turn[2]]))[0] @ cv2.Rodrigues(np.array([turn[0], turn[1], 0]))[0]
        middle = np.array([columns, rows, 0]) * SQUARE / 2
        # the last four hang out of the picture
        aside = np.array([[-0.09, -0.06], [0.1, 0.05], [-0.1, 0.06], [0.09, -0.07]])[i % 4] * (1 if i >= N - 4 else 0.3)
        t = np.array([*aside, rng.uniform(0.28, 0.38)]) - R @ middle
        # z (R' ray) - R' t lies on the plane z = 0 of the board
        direction, from_ = rays @ R, -R.T @ t
        away = -from_[2] / direction[:, 2]
        x, y = (from_[:2, None] + away * direction[:, :2].T) / SQUARE * per + per / 2 - 0.5
        fine = cv2.remap(flat, x.reshape(u.shape).astype(np.float32), y.reshape(u.shape).astype(np.float32),
                         cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=140)
        picture = cv2.resize(fine, SIZE, interpolation=cv2.INTER_AREA)
        picture = cv2.GaussianBlur(picture, (0, 0), 0.6).astype(float) * 0.75 + 25 + rng.normal(0, 2, picture.shape)
        pictures.append(np.clip(picture + 0.5, 0, 255).astype(np.uint8))
        if folder:
            cv2.imwrite('%s/%s%02d.png' % (folder, name, i), pictures[-1])
    return pictures


def draw_flat(board, columns, rows, per):
    """The board, and half a square of white around it."""
    flat = board.draw((columns * per, rows * per), None, 0, 1)
    return cv2.copyMakeBorder(flat, per // 2, per // 2, per // 2, per // 2, cv2.BORDER_CONSTANT, value=255)


def peer(board, dictionary, pictures):
    """OpenCV's own."""
    corners, numbers = [], []
    for picture in pictures:
        found, ids, _ = aruco.detectMarkers(picture, dictionary)
        n, c, i = aruco.interpolateCornersCharuco(found, ids, picture, board)
        if n >= 6:
            corners.append(c)
            numbers.append(i)
    return aruco.calibrateCameraCharuco(corners, numbers, board, SIZE, None, None)[1], sum(map(len, corners))


if keep:
    for i, seen in enumerate(draw(None, make_board(8, 7, '5X5_100')[0], 8, 7, '', 3)):
        if i % 2:
            cv2.imwrite('%s/left%02d.jpg' % (keep, i), seen, [cv2.IMWRITE_JPEG_QUALITY, 90])
    sys.exit(0)

with tempfile.TemporaryDirectory() as folder:
    output = os.path.join(folder, 'rig.json')
    # Odd and even: where the first square is black in both of OpenCV's ways to print it, and in one.
    for columns, rows, name, seed in ((8, 7, 'DICT_5X5_100', 3), (9, 6, '4x4_50', 4)):
        board, dictionary = make_board(columns, rows, name)
        first = 'black' if board.draw((columns * 20, rows * 20), None, 0, 1)[10, 1] < 128 else 'white'
        other = {'black': 'white', 'white': 'black'}[first]
        pictures = draw(folder, board, columns, rows, name, seed)
        films = '%s=%s/%s*.png' % ('a', folder, name)
        kind = ['--columns', str(columns), '--rows', str(rows), '--square', '30mm', '--first', first,
                '--charuco', name, '--marker', '22mm']
        done = run(*kind, '--output', output, films)
        check(done.returncode == 0, '%s: %s' % (name, done.stderr[-300:] if done.returncode else 'calibrated'))
        if done.returncode:
            continue
        views = re.search(r'board found in (\d+) of (\d+) pictures, \d+ views and (\d+) corners', done.stdout)
        with open(output, encoding='utf-8') as file:
            camera = json.load(file)['cameras'][0]
        own, sigma = np.array(camera['K']), camera['standard_deviations']['K']
        theirs, n_theirs = peer(board, dictionary, pictures)
        numbers = [(m[0, 0], m[1, 1], m[0, 2], m[1, 2]) for m in (own, theirs, K)]
        off = [np.abs(np.subtract(numbers[k], numbers[2])) for k in (0, 1)]
        print('%s: found in %s of %s, %s corners (OpenCV %d)\n  off by %s px, sigma %s; OpenCV off by %s'
              % (name, *views.groups(), n_theirs, np.round(off[0], 3), np.round(sigma, 3), np.round(off[1], 3)))
        check(views[1] == str(N), name + ': found in all pictures, upside down and in part too')
        check(int(views[3]) >= 0.97 * n_theirs, name + ': as many corners as OpenCV finds')
        check(np.all(off[0] < 4 * np.array(sigma)) and np.max(off[0]) < 1.5, name + ': the camera as it is')
        check(np.sum(off[0]) < np.sum(off[1]), name + ": nearer than OpenCV's")
        check('RMS' in done.stdout, name + ': report')
        # What is said wrongly is told, not calibrated.
        wrong = list(kind)
        wrong[kind.index('--first') + 1] = other
        done = run(*wrong, '--output', output + '2', films)
        check(done.returncode == 1 and '--first ' + first in done.stderr and not os.path.exists(output + '2'),
              name + ': the other colour first: ' + done.stderr.strip()[-160:])
    plain = ['--columns', '9', '--rows', '6', '--square', '30mm', '--first', first]
    for code, says, arguments in (
            (2, 'there are 4X4_50, 4X4_100', ['--charuco', '9X9_50', '--marker', '22mm']),
            (2, 'say how large the markers are', ['--charuco', '4X4_50']),
            (2, 'inside of squares', ['--charuco', '4X4_50', '--marker', '30mm']),
            (2, 'inside of squares', ['--charuco', '4X4_50', '--marker', '0mm']),
            (2, 'give a length', ['--charuco', '4X4_50', '--marker', '22']),
            (2, 'of which dictionary', ['--marker', '22mm']),
            (2, 'it has 30 markers', ['--charuco', 'APRILTAG_16h5', '--marker', '22mm', '--columns', '10', '--rows', '7']),
            (1, 'no picture has a marker of 6X6_50', ['--charuco', '6X6_50', '--marker', '22mm']),
            (1, 'not where a board of 6 × 9 squares has them', ['--charuco', '4X4_50', '--marker', '22mm', '--columns', '6',
                                                               '--rows', '9']),
            (1, 'each 0.333 of a square', ['--charuco', '4X4_50', '--marker', '10mm']),
            (2, 'has no pattern.json', ['--pattern', 'x.json', '--marker', '22mm']),
            (2, 'not both', ['--charuco', '4X4_50', '--marker', '22mm', '--pattern', 'x.json'])):
        done = run(*plain, *arguments, '--output', output + '2', films)
        check(done.returncode == code and says in done.stderr and not os.path.exists(output + '2'),
              '%s: %s' % (' '.join(arguments), done.stderr.strip()[-160:]))
sys.exit(failed > 0)
