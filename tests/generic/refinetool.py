#!/usr/bin/python3
"""gst-cloth-calibrate-1.0 refine: eight cameras of a path-traced film of dots, three of which the
rig has wrong, are set right by the cloth; and what it refuses.

  refinetool.py TOOL TEST_DATA

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

tool, data = sys.argv[1:]
ring = os.path.join(data, 'dots_moving')
folder = tempfile.mkdtemp(prefix='cloth-refine-')
take = os.path.join(folder, 'take')
faults = []


def check(condition, text):
    print(('ok    ' if condition else 'FAULT ') + text)
    if not condition:
        faults.append(text)


def run(rig, where=take):
    return subprocess.run([tool, 'refine', rig, where, '--output', folder + '/refined.json'],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=200,
                          encoding='utf-8', env=dict(os.environ, LC_ALL='C.UTF-8'))


def film():
    """What the cameras see, and nothing else: no positions."""
    os.makedirs(take + '/observations')
    for camera in range(8):
        subprocess.run(
            ['gst-launch-1.0', '-q', 'filesrc', 'location=%s/cam%d.mp4' % (ring, camera), '!',
             'decodebin', '!', 'videoconvert', '!', 'dotlabel', 'pattern=%s/pattern.json' % ring,
             'camera=cam%d' % camera, '!', 'clothmetapay', '!', 'filesink',
             'location=%s/observations/cam%d.obs' % (take, camera)], check=True, timeout=200)
    with open(ring + '/pattern.json', encoding='utf-8') as file:
        pattern = json.load(file)
    with open(take + '/take.json', 'w', encoding='utf-8') as file:
        json.dump({'version': 1, 'name': 'ring', 'fps': 25, 'grid': {
            'columns': pattern['columns'], 'rows': pattern['rows'],
            'width_m': pattern['pitch_m'] * (pattern['columns'] - 1),
            'height_m': pattern['pitch_m'] * (pattern['rows'] - 1)}}, file)
    np.save(take + '/times.npy', np.arange(25) / 25)
    shutil.copy(ring + '/rig.json', take + '/rig.json')


def turned(R, vector):
    """R after a small turn about the camera's axes."""
    angle = np.linalg.norm(vector)
    x, y, z = np.asarray(vector) / angle
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return (np.eye(3) + math.sin(angle) * K + (1 - math.cos(angle)) * K @ K) @ R


def amiss(cameras):
    """The rig as somebody left it: a camera was knocked, a lens refocused, a clock is off."""
    R, t = np.array(cameras[1]['R']), np.array(cameras[1]['t'])
    back = turned(np.eye(3), [0.002, -0.002, 0.001])
    cameras[1]['R'], cameras[1]['t'] = (back @ R).tolist(), (back @ t).tolist()
    for i in range(2):
        cameras[3]['K'][i][i] *= 1.01
    cameras[5]['offset_s'] = 0.04


def compare(truth, cameras):
    """Of each camera, how far off it is: rad, m, share, s."""
    result = []
    for a, b in zip(truth, cameras):
        R, S = np.array(a['R']), np.array(b['R'])
        angle = math.acos(min(1, (np.trace(S @ R.T) - 1) / 2))
        centre = S.T @ np.array(b['t']) - R.T @ np.array(a['t'])
        result.append((angle, np.linalg.norm(centre), b['K'][0][0] / a['K'][0][0] - 1,
                       b.get('offset_s', 0) - a.get('offset_s', 0)))
    return np.array(result)


def load(path):
    with open(path, encoding='utf-8') as file:
        return json.load(file)


film()
whole = load(ring + '/rig.json')
truth = load(ring + '/rig.json')['cameras']
amiss(whole['cameras'])
with open(folder + '/amiss.json', 'w', encoding='utf-8') as file:
    json.dump(whole, file)

# the true rig: what the film itself leaves
done = run(ring + '/rig.json')
print(done.stdout, done.stderr)
check(done.returncode == 0, 'the true rig is taken')
right = compare(truth, load(folder + '/refined.json')['cameras'])
floor = float(re.search(r'disagree by ([\d.]+) px', done.stdout).group(1))
figures = re.compile(r'freedom: ([\d.]+), was ([\d.]+); .*others: ([\d.]+)%, were ([\d.]+)%')
chi = [float(x) for x in figures.search(done.stdout).groups()]
check(0.8 < chi[1] < 1.2, 'with the true rig χ² is %.3f' % chi[1])
contradicted = chi[3]

done = run(folder + '/amiss.json')
print(done.stdout, done.stderr)
check(done.returncode == 0, 'the wrong rig is taken')
rig = load(folder + '/refined.json')['cameras']
off = compare(truth, rig)
before = compare(truth, whole['cameras'])
chi = [float(x) for x in figures.search(done.stdout).groups()]
check(0.8 < chi[0] < 1.2, 'χ² %.2f → %.3f' % (chi[1], chi[0]))
check(chi[3] > 20 and chi[2] < contradicted + 1, 'contradicting: %.1f%% → %.1f%%, with the true rig '
      '%.1f%%' % (chi[3], chi[2], contradicted))
check(abs(float(re.search(r'disagree by ([\d.]+) px', done.stdout).group(1)) / floor - 1) < 0.1,
      'the cameras agree as with the true rig')
for camera, column, unit, name in ((1, 0, 1e3, 'mrad'), (3, 2, 100, '%'), (5, 3, 1e3, 'ms')):
    sd = rig[camera]['standard_deviations']
    sigma = {0: np.linalg.norm(sd['rotation']), 2: sd['K'][0] / rig[camera]['K'][0][0],
             3: sd['offset_s']}
    value = abs(off[camera][column])
    check(value < 3 * sigma[column], 'cam%d: off by %.3f %s, was %.3f, 3σ is %.3f' % (
        camera, unit * value, name, unit * abs(before[camera][column]),
        unit * 3 * sigma[column]))
# what was right stays so: as far off as when nothing was wrong, and what the noise makes
check((np.abs(off[:, 3]) < 1e-3).all(), 'clocks within 1 ms: %s' % np.abs(off[:, 3]).max())
check((off[:, 0] < right[:, 0].max() + 5e-4).all(), 'directions: %.3f mrad at most, %.3f with the '
      'true rig' % (1e3 * off[:, 0].max(), 1e3 * right[:, 0].max()))

for rig_file, where, says in (
        (os.path.join(data, 'opencv_boards/none.json'), take, 'none.json'),
        (ring + '/rig.json', os.path.join(data, 'take_drag'), 'no folder observations'),
        (os.path.join(data, 'dots_ring8/rig.json'), take, 'of no camera of the rig')):
    os.path.exists(folder + '/refined.json') and os.unlink(folder + '/refined.json')
    done = run(rig_file, where)
    check(done.returncode == 1 and says in done.stderr
          and not os.path.exists(folder + '/refined.json'), 'refused: ' + done.stderr.strip())
done = subprocess.run([tool, 'refine', ring + '/rig.json', '--output', folder + '/refined.json'],
                      stderr=subprocess.PIPE, encoding='utf-8', check=False)
check(done.returncode == 2 and 'refine RIG TAKE' in done.stderr, 'a take is asked for')

shutil.rmtree(folder)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
