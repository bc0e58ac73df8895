#!/usr/bin/python3
"""gst-cloth-fit-1.0: a falling cloth that three cameras filmed is fitted, and what nobody saw of it is
nearer the truth than filled holes are; and what it refuses.

  fittool.py TOOL TEST_DATA

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

import numpy as np

tool, data = sys.argv[1:]
films = os.path.join(data, 'lineart_stereo3')
folder = tempfile.mkdtemp(prefix='cloth-fit-')
take = os.path.join(folder, 'take')
faults = []
MODEL = {'version': 1, 'areal_density': 0.18, 'stretch': {'warp': 60, 'weft': 60}, 'shear': 15,
         'bending': {'warp': 2e-5, 'weft': 2e-5}, 'damping': {'mass': 0.5, 'stiffness': 1e-3},
         'free': [{'name': 'stretch.warp', 'range': [5, 1000]},
                  {'name': 'shear', 'range': [1, 300]},
                  {'name': 'damping.mass', 'range': [0.01, 20]}]}


def check(condition, text):
    print(('ok    ' if condition else 'FAULT ') + text)
    if not condition:
        faults.append(text)


def run(*arguments):
    return subprocess.run([tool, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          timeout=300, encoding='utf-8', env=dict(os.environ, LC_ALL='C.UTF-8'))


def launch(*words):
    subprocess.run(['gst-launch-1.0', '-q', *words], check=True, timeout=200)


def detect(camera):
    return ['filesrc', 'location=%s/cam%d.mp4' % (films, camera), '!', 'decodebin', '!', 'videoconvert',
            '!', 'silhouette', 'background=%s/background%d.png' % (films, camera), '!', 'siftmatch', 'pattern=%s/pattern.json' % films, 'camera=cam%d' % camera,
            'follow=true', '!']


def write(path, what):
    with open(path, 'w', encoding='utf-8') as file:
        json.dump(what, file)
    return path


truth = np.load(films + '/vertices.npy')
os.makedirs(take + '/observations')
shutil.copy(films + '/rig.json', take)
words = []
for n in range(3):
    words += detect(n) + ['tee', 'name=t%d' % n, 't%d.' % n, '!', 'queue', '!', 'join.', 't%d.' % n, '!',
                          'queue', '!', 'clothmetapay', '!', 'filesink',
                          'location=%s/observations/cam%d.obs' % (take, n)]
launch('triangulate', 'name=join', 'rig=%s/rig.json' % films, 'pattern=%s/pattern.json' % films, '!',
       'tee', 'name=m', '!', 'queue', '!', 'meshsink', 'location=%s/raw' % folder, 'format=take', 'm.',
       '!', 'queue', '!', 'meshfill', '!', 'meshsink', 'location=%s/filled' % folder, 'format=take',
       *words)
np.save(take + '/times.npy', np.arange(len(truth)) / 25)
np.save(take + '/clamps.npy', truth[:1, :1])
info = {'version': 1, 'notes': 'kept', 'obstacles': [{'type': 'plane', 'point': [0, 0, -9], 'normal': [0, 0, 1],
                                                      'friction': 0.3}], 'name': 'falling', 'fps': 25, 'held': [{'vertex': 0}],
        'grid': {'columns': 33, 'rows': 35, 'width_m': 0.63, 'height_m': 0.67}}
write(take + '/take.json', info)
model = write(folder + '/model.json', MODEL)
out = folder + '/out'
done = run('fit', take, '--model', model, '--output', out)
print(done.stdout, done.stderr)
check(done.returncode == 0, 'it is fitted')

raw, filled = np.load(folder + '/raw/positions.npy'), np.load(folder + '/filled/positions.npy')
fitted, states = np.load(out + '/take0/positions.npy'), np.load(out + '/take0/states.npy')
n = min(len(raw), len(filled), len(truth))
lost = np.isnan(raw[:n, :, 0]) & np.isfinite(filled[:n, :, 0])
rms = {name: 1e3 * np.sqrt((np.linalg.norm(x[:n] - truth[:n], axis=2)[lost] ** 2).mean())
       for name, x in (('filled', filled), ('fitted', fitted))}
check(lost.mean() > 0.2 and rms['fitted'] < 12 and rms['fitted'] < rms['filled'] / 2,
      'of %.0f%% of the vertices that fewer than two cameras see: fitted %.1f mm RMS off, filled %.1f' % (
          100 * lost.mean(), rms['fitted'], rms['filled']))
check(set(np.unique(states)) == {1, 4} and np.isfinite(fitted).all(), 'measured or predicted, no holes')
told = json.load(open(out + '/fit.json', encoding='utf-8'))
check([x['name'] for x in told['numbers']] == [x['name'] for x in MODEL['free']]
      and all(x['sigma'] > 0 for x in told['numbers']), 'its numbers, with deviations')
cameras = told['takes'][0]['cameras']
seen = [x for c in cameras for x in c['drawn_px'] if x is not None]
check(len(cameras) == 3 and len(seen) > 50 and np.median(seen) < 5,
      'in the pictures it is %.2f px off in the median' % np.median(seen))
drawn, let_go = ([x for c in cameras for x in c[name]] for name in ('drawn_overlap', 'let_go_overlap'))
check(len(drawn) == 60 and np.median(drawn) > 0.98 and np.mean(drawn) > np.mean(let_go) > 0.8,
      'it covers %.3f of its silhouettes in the median, let go %.3f' % (
          np.median(drawn), np.median(let_go)))
check('on an outline' in done.stdout, 'outlines are told of')
check(told['takes'][0]['after']['drawn_m'] < told['takes'][0]['before']['drawn_m'], 'it is nearer')
with open(out + '/fitted.json', encoding='utf-8') as file:
    warp = json.load(file)['stretch']['warp']
    check(abs(warp / told['numbers'][0]['value'] - 1) < 1e-4, 'fitted.json has them')
with open(out + '/take0/take.json', encoding='utf-8') as file:
    kept = json.load(file)
    check(kept['notes'] == 'kept' and kept['obstacles'][0]['type'] == 'plane', 'the fitted take has the scene')
with open(out + '/fit.html', encoding='utf-8') as file:
    check('<html' in file.read(2000), 'a page')

# A take of one frame seen, and what stands in the way of the cloth.
unseen = folder + '/unseen'
os.makedirs(unseen)
np.save(unseen + '/positions.npy', np.where(np.arange(len(truth))[:, None, None] < 1, truth, np.nan).astype('f4'))
np.save(unseen + '/times.npy', np.arange(len(truth)) / 25)
np.save(unseen + '/clamps.npy', truth[:, :1])
write(unseen + '/take.json', info)

frozen = write(folder + '/frozen.json', dict(MODEL, free=[]))
bare = os.path.join(folder, 'bare')
os.makedirs(bare)
write(bare + '/take.json', info)
with open(films + '/rig.json', encoding='utf-8') as file:
    small = json.load(file)
for camera in small['cameras']:
    camera['size'] = [640, 480]
for code, says, arguments in (
        (1, 'has pictures of 640 × 480 pixels', ('fit', take, '--model', model, '--output', out, '--rig',
                                                write(folder + '/small.json', small))),
        (1, 'no free numbers', ('fit', take, '--model', frozen, '--output', out)),
        (1, 'positions.npy', ('fit', bare, '--model', model, '--output', out)),
        (1, '--model', ('fit', take, '--model', folder + '/none.json', '--output', out)),
        (1, "the take's 1024 × 768", ('fit', take, '--model', model, '--output', out,
                                                  '--rig', data + '/dots_ring8/rig.json')),
        (1, 'would be overwritten', ('fit', out + '/take0', '--model', model, '--output', out)),
        (1, 'no take has a folder observations', ('fit', out + '/take0', '--model', model, '--output', folder + '/b',
                                                  '--rig', take + '/rig.json')),
        (1, 'nothing of the cloth was seen', ('fit', unseen, '--model', model, '--output', folder + '/b')),
        (2, '--evaluations', ('fit', take, '--model', model, '--output', out, '--evaluations', '5')),
        (2, 'name the takes', ('fit', '--model', model, '--output', out)),
        (2, '--output', ('fit', take, '--model', model)),
        (2, 'name the command', ('guess', take, '--model', model, '--output', out)),
        (2, '--threads', ('fit', take, '--model', model, '--output', out, '--threads', '-1'))):
    done = run(*arguments)
    check(done.returncode == code and says in done.stderr and 'CRITICAL' not in done.stderr,
          'refused: ' + done.stderr.strip())

check(not os.path.exists(folder + '/b'), 'what fails leaves no folder')

# A rig of the command line stands for the take's own, in whatever order it has the cameras.
os.rename(take + '/rig.json', folder + '/rig.json')
with open(folder + '/rig.json', encoding='utf-8') as file:
    turned = json.load(file)
turned['cameras'].reverse()
for says, rig in (('no rig.json', []), ('no free numbers', ['--rig', write(folder + '/turned.json', turned)])):
    done = run('fit', take, '--model', frozen, '--output', out, *rig)
    check(done.returncode == 1 and says in done.stderr, 'a take without a rig: ' + done.stderr.strip())

shutil.rmtree(folder)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
