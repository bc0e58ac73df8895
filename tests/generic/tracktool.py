#!/usr/bin/python3
"""gst-cloth-fit-1.0 track: points of a cloth that is lifted are near the truth, tables are read by other
programs; and what it refuses.

  tracktool.py TOOL TAKE_TOOL TEST_DATA

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import csv
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

tool, take_tool, data = sys.argv[1:]
lift = os.path.join(data, 'corner_lift')
folder = tempfile.mkdtemp(prefix='cloth-track-')
faults = []
FRAMES = 8
COLUMNS, ROWS, WIDTH, HEIGHT = 33, 35, 0.63, 0.67


def check(condition, text):
    print(('ok    ' if condition else 'FAULT ') + text)
    if not condition:
        faults.append(text)


def run(*arguments, program=tool):
    return subprocess.run([program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          timeout=200, encoding='utf-8', env=dict(os.environ, LC_ALL='C.UTF-8'))


def launch(*words):
    subprocess.run(['gst-launch-1.0', '-q', *words], check=True, timeout=100)


def cut(camera, frames, name, rate=25):
    """The first pictures of a film."""
    path, pictures = os.path.join(folder, name), os.path.join(folder, '%d-%%03d.jpg' % camera)
    if not os.path.exists(pictures % 0):
        launch('filesrc', 'location=%s/repeated/cam%d.mp4' % (lift, camera), '!', 'qtdemux', '!', 'h264parse', '!',
               'avdec_h264', '!', 'jpegenc', 'quality=97', '!', 'multifilesink', 'location=' + pictures)
    launch('multifilesrc', 'location=' + pictures, 'stop-index=%d' % (frames - 1),
           'caps=image/jpeg,framerate=%d/1' % rate, '!', 'jpegparse', '!', 'avimux', '!', 'filesink', 'location=' + path)
    return path


def surface(frame, u, v):
    x, y = u / WIDTH * (COLUMNS - 1), v / HEIGHT * (ROWS - 1)
    i, j = np.clip(int(x), 0, COLUMNS - 2), np.clip(int(y), 0, ROWS - 2)
    cell = truth[frame].reshape(ROWS, COLUMNS, 3)[j:j + 2, i:i + 2]
    across = cell[:, 0] * (1 - x + i) + cell[:, 1] * (x - i)
    return across[0] * (1 - y + j) + across[1] * (y - j)


truth = np.load(lift + '/vertices.npy')
films = [cut(c, FRAMES, 'cam%d.avi' % c) for c in range(4)]
backgrounds = sum((['--background', '%s/background%d.png' % (lift, c)] for c in range(4)), [])
out = os.path.join(folder, 'out')


def words(tracker, films=films, backgrounds=backgrounds, size='63cm,67cm', rig=lift + '/rig.json', output=out, more=()):
    return ['track', *films, '--rig', rig, '--tracker', tracker, '--pattern-size', size, *backgrounds,
            '--ground', '0.006', '--near', '-0.31,0.33', '--output', output, *more]


done = run(*words('multi'))
check(done.returncode == 0, 'markers are tracked: ' + done.stderr)
with open(out + '/track.json', encoding='utf-8') as file:
    told = json.load(file)
check(told['tracker'] == 'multi' and told['cameras'] == ['cam0', 'cam1', 'cam2', 'cam3']
      and len(told['frames']) == FRAMES, 'each frame is told')
start = told['start']
check(np.hypot(start['x_m'] - truth[0, 0, 0], start['y_m'] - truth[0, 0, 1]) < 0.002, 'and where the cloth lay')
last = told['frames'][-1]
off = [np.linalg.norm(surface(FRAMES - 1, u, v) - (x, y, z)) for u, v, x, y, z in zip(
    *(last[key] for key in ('u_m', 'v_m', 'x_m', 'y_m', 'z_m')))]
check(last['points'] == len(off) > 100 and np.median(off) < 0.003,
      'the last has %d markers, %.1f mm off in the median' % (len(off), 1e3 * np.median(off)))
with open(out + '/markers.csv', encoding='utf-8', newline='') as file:
    lines = list(csv.DictReader(file))
check(len(lines) == sum(frame['points'] for frame in told['frames'])
      and abs(float(lines[-1]['z_m']) - last['z_m'][-1]) < 2e-6, 'markers.csv has them as well')
done = run('import', out + '/markers.csv', '--units', 'm', '--rate', '25', '--columns', '2', '--rows', '2',
           '--width', '10cm', '--height', '10cm', '--output', folder + '/taken', program=take_tool)
check('markers' in done.stdout + done.stderr and 'expected in a line' not in done.stderr,
      'which the import of takes can read')

done = run(*words('uvless', more=['--anneal', '--seed', '3', '--threads', '1']))
with open(out + '/track.json', encoding='utf-8') as file:
    told = json.load(file)
last = told['frames'][-1]
moved = np.hypot(np.subtract(last['x_px'], last['before_x_px']), np.subtract(last['y_px'], last['before_y_px']))
check(done.returncode == 0 and 'u_m' not in last and told['frames'][0]['points'] == 0 and last['points'] > 1000
      and np.median(moved) < 1, 'features without (u, v), after annealing')

short = cut(2, 3, 'short.avi')
done = run(*words('lucas-kanade', films=[films[0], films[1], short, films[3]]))
with open(out + '/track.json', encoding='utf-8') as file:
    told = json.load(file)
check(done.returncode == 0 and len(told['frames']) == 3 and 'short.avi ends after 3 pictures' in done.stderr,
      'the shortest film ends it, which is said')

# a take of a hand whose path nobody knows, which a cloth can be fitted to
out = os.path.join(folder, 'take')
done = run(*words('lucas-kanade', output=out, more=['--grid', '17,18', '--held', '0']))
coarse = truth.reshape(-1, ROWS, COLUMNS, 3)[:, ::2, ::2].reshape(len(truth), -1, 3)
arrays = {name: np.load('%s/%s.npy' % (out, name)) for name in ('positions', 'times', 'clamps')}
check(done.returncode == 0 and len(arrays['times']) == FRAMES and abs(arrays['times'][2] - 0.08) < 1e-3
      and arrays['clamps'].shape == (1, 1, 3) and np.isnan(arrays['clamps']).all()
      and np.linalg.norm(arrays['positions'][0] - coarse[0], axis=1).max() < 0.003, 'a take: ' + done.stderr)
with open(folder + '/model.json', 'w', encoding='utf-8') as file:
    json.dump({'version': 1, 'areal_density': 0.18, 'stretch': {'warp': 60, 'weft': 60}, 'shear': 15,
               'bending': {'warp': 2e-5, 'weft': 2e-5}, 'damping': {'mass': 0.5, 'stiffness': 0.001},
               'free': [{'name': 'damping.mass', 'range': [0.01, 20]}]}, file)
done = run('fit', out, '--model', folder + '/model.json', '--output', folder + '/fit')
fitted = np.load(folder + '/fit/take0/positions.npy') if done.returncode == 0 else np.full(coarse[:FRAMES].shape, np.nan)
off = np.linalg.norm(fitted - coarse[:FRAMES], axis=2)
hand = np.linalg.norm(np.load(folder + '/fit/take0/clamps.npy')[:, 0] - coarse[:FRAMES, 0], axis=1)
check(np.sqrt((off ** 2).mean()) < 0.003 and np.sqrt((hand ** 2).mean()) < 0.02,
      'fitted %.1f mm off, and the hand %.1f mm: %s' % (1e3 * np.sqrt((off ** 2).mean()),
                                                      1e3 * np.sqrt((hand ** 2).mean()), done.stderr))

out = os.path.join(folder, 'out')

texts = []
for threads in '1', '3':
    run(*words('frames', films=[cut(c, 2, 'two%d.avi' % c) for c in range(4)], more=['--threads', threads]))
    with open(out + '/track.json', encoding='utf-8') as file:
        texts.append(file.read())
check(texts[0] == texts[1] and '"tracker": "frames"' in texts[0], 'threads change nothing')

fresh = os.path.join(folder, 'fresh')
other = os.path.join(data, 'lineart_stereo3')
with open(folder + '/text.avi', 'w', encoding='utf-8') as file:
    file.write('no film')
with open(folder + '/file', 'w', encoding='utf-8') as file:
    file.write('no folder')
for code, text, line in (
        (2, 'name the films and --rig', ['track', *films]),
        (2, 'there is none of that name; give one of reference, frames, multi', words('best', output=fresh)),
        (2, 'give width and height', words('multi', size='63cm', output=fresh)),
        (2, 'give a length with its unit', words('multi', size='63,67', output=fresh)),
        (2, '--near: give x and y', words('multi', output=fresh, more=['--near', 'left'])),
        (2, '--threads', words('multi', output=fresh, more=['--threads', '-1'])),
        (2, 'lucas-kanade does', words('multi', output=fresh, more=['--grid', '33,35'])),
        (2, 'give columns and rows', words('lucas-kanade', output=fresh, more=['--grid', '1,35'])),
        (2, 'give columns and rows', words('lucas-kanade', output=fresh, more=['--grid', '33x35'])),
        (2, 'give columns and rows', words('lucas-kanade', output=fresh, more=['--held', '0'])),
        (2, 'give vertices', words('lucas-kanade', output=fresh, more=['--grid', '3,5', '--held', '15'])),
        (2, 'give vertices', words('lucas-kanade', output=fresh, more=['--grid', '3,5', '--held', '0,'])),
        (2, 'each once', words('lucas-kanade', output=fresh, more=['--grid', '3,5', '--held', '2,2'])),
        (2, 'more than the 65536', words('lucas-kanade', output=fresh, more=['--grid', '300,300'])),
        (1, 'must run in step', words('multi', films=films[:3] + [cut(3, 3, 'fast.avi', 50)], output=fresh)),
        (1, 'is a take already', words('lucas-kanade', output=folder + '/take', more=['--grid', '17,18'])),
        (2, 'are not of the command track', words('multi', output=fresh, more=['--model', 'a.json'])),
        (2, 'are of the command track', ['fit', 'take', '--model', 'a.json', '--output', fresh, '--anneal']),
        (1, '4 cameras, and 3 films and 4 backgrounds', words('multi', films=films[:3], output=fresh)),
        (1, '4 cameras, and 4 films and 2 backgrounds', words('multi', backgrounds=backgrounds[:4], output=fresh)),
        (1, 'none.mp4: there is no such file', words('multi', films=['none.mp4'] + films[1:], output=fresh)),
        (1, 'text.avi', words('multi', films=[folder + '/text.avi'] + films[1:], output=fresh)),
        (1, '1024 × 768 pixels, camera “cam0” of the rig 640 × 480',
         words('multi', films=[other + '/cam0.mp4'] + films[1:], output=fresh)),
        (1, 'none.json', words('multi', rig=folder + '/none.json', output=fresh)),
        (1, 'its background has 1024 × 768', words('multi', output=fresh, backgrounds=[
            '--background', other + '/background0.png'] + backgrounds[2:])),
        (1, 'sees a rectangle of', words('multi', size='90cm,67cm', output=fresh)),
        (1, 'cannot make the folder', words('multi', films=[folder + '/two0.avi'] + films[1:], output=folder + '/file/in'))):
    done = run(*line)
    check(done.returncode == code and text in done.stderr and not os.path.exists(fresh), 'refused: ' + text)
    if text not in done.stderr:
        print(done.stderr)

sys.exit(bool(faults))
