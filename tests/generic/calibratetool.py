#!/usr/bin/python3
"""gst-cloth-calibrate-1.0: real boards, films, imports, and everything that can go wrong.

  calibratetool.py TOOL TEST_DATA VERSION

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import math
import os
import re
import stat
import subprocess
import sys
import tempfile

tool, data, version = sys.argv[1:]
boards = os.path.join(data, 'opencv_boards')
multidic = os.path.join(data, 'multidic')
pattern = os.path.join(boards, 'pattern.json')
faults = []
folder = tempfile.mkdtemp(prefix='cloth-calibrate-')
output = os.path.join(folder, 'rig.json')


def check(condition, text):
    print(('ok    ' if condition else 'FAULT ') + text)
    if not condition:
        faults.append(text)


def run(*arguments):
    return subprocess.run([tool, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          stdin=subprocess.DEVNULL, timeout=200, encoding='utf-8',
                          env=dict(os.environ, LC_ALL='C.UTF-8'))


def calibrate(*arguments):
    """The report and the rig."""
    if os.path.exists(output):
        os.unlink(output)
    done = run('--output', output, *arguments)
    if done.returncode:
        print(done.stderr)
        check(False, 'calibrate ' + ' '.join(arguments))
        sys.exit(1)
    with open(output, encoding='utf-8') as file:
        return done.stdout, json.load(file)['cameras']


def rms(report):
    return [float(x) for x in re.findall(r'RMS (\d+\.\d+) px', report)]


def refused(code, says, *arguments):
    if os.path.exists(output):
        os.unlink(output)
    done = run(*arguments)
    check(done.returncode == code and says in done.stderr and not os.path.exists(output)
          and 'CRITICAL' not in done.stderr,
          '%s → %d, "%s"%s' % (' '.join(os.path.basename(a) for a in arguments), code, says,
                               '' if says in done.stderr else ', not ' + done.stderr[-300:]))


def matrix(camera):
    return [list(row) + [t] for row, t in zip(camera['R'], camera['t'])]


def relative(first, second):
    """Rotation vector's length (rad) and translation (m) from the first camera to the second."""
    a, b = matrix(first), matrix(second)
    r = [[sum(b[i][k] * a[j][k] for k in range(3)) for j in range(3)] for i in range(3)]
    t = [b[i][3] - sum(r[i][k] * a[k][3] for k in range(3)) for i in range(3)]
    return math.acos(min(1, (r[0][0] + r[1][1] + r[2][2] - 1) / 2)), t


# The real pair, each camera alone. Reference: cornerSubPix reaches 0.195 and 0.207 px.
for side, limit, subpix in (('left', 0.165, 0.195), ('right', 0.163, 0.207)):
    report, cameras = calibrate('--pattern', pattern, '%s=%s/%s*.jpg' % (side, boards, side))
    check('board found in 13 of 13 pictures, 13 views and 702 corners' in report,
          side + ': all boards found')
    check(rms(report)[0] <= limit, '%s: RMS %.3f px, to reach %.3f (cornerSubPix %.3f)'
          % (side, rms(report)[0], limit, subpix))
    check(cameras[0]['standard_deviations']['K'][0] < 0.6, '%s: fx ± %.2f px'
          % (side, cameras[0]['standard_deviations']['K'][0]))

# Three pictures put the centre 5 px beside that of all of them, and say that they may.
report, few = calibrate('--pattern', pattern, *('left=%s/left0%d.jpg' % (boards, i) for i in (1, 2, 3)))
_, cameras = calibrate('--pattern', pattern, 'left=%s/left*.jpg' % boards)
off = few[0]['K'][0][2] - cameras[0]['K'][0][2]
check(abs(off) > 3 and '3 views are too few' in report and 'mostly at the left' in report,
      'three pictures: cx off by %.1f ± %.2f px, with a warning' % (off, few[0]['standard_deviations']['K'][2]))
report, _ = calibrate('--pattern', pattern, 'left=%s/left*.jpg' % boards)
check('too few' not in report and 'the views disagree' in report
      and re.search(r'at infinity +0\.\d+ +\d+\.\d+ ', report), 'all pictures: projections and their warning')

# The one board is bent the same, whichever camera sees it.
bends = []
for side in ('left', 'right'):
    report, _ = calibrate('--pattern', pattern, '--warp', '%s=%s/%s*.jpg' % (side, boards, side))
    bends.append([float(x) for x in re.findall(r'(-?[\d.]+) ± [\d.]+ mm', report)[:2]])
    check(rms(report)[0] < 0.155, '%s: RMS %.3f px where the board may be bent' % (side, rms(report)[0]))
check(math.dist(*bends) < 0.04 and bends[0][1] < -0.3, 'bent by %s mm, and by %s mm' % tuple(bends))

# OpenCV's own calibration of the left camera, published with the pictures; one of its views
# is off by 1.2 px (RMS 0.393 px).
_, cameras = calibrate('--pattern', pattern, 'left=%s/left*.jpg' % boards)
own, published = cameras[0]['K'], (535.91573396, 342.28315473, 235.57082910)
check(abs(own[0][0] / published[0] - 1) < 0.01 and math.dist((own[0][2], own[1][2]), published[1:]) < 2,
      'left: f %.2f px, centre %.2f %.2f; published %.2f, %.2f %.2f'
      % (own[0][0], own[0][2], own[1][2], *published))

# Both together, against cv2.stereoCalibrate on corners of its own (tests/core/calibrate.c).
report, cameras = calibrate('--pattern', pattern, 'left=%s/left*.jpg' % boards,
                            'right=%s/right*.jpg' % boards)
angle, t = relative(*cameras)
check(math.dist(t, (-0.0831763, 0.0009199, -0.0001179)) < 0.0003 and abs(angle - 0.00899) < 0.003,
      'pair: baseline %.3f mm, turned by %.4f rad; OpenCV 83.181 mm, 0.0090 rad'
      % (1e3 * math.hypot(*t), angle))
check('13 views shared' in report and 'left14.jpg' in report, 'pair: report')
first = open(output, 'rb').read()
calibrate('--pattern', pattern, 'left=%s/left*.jpg' % boards, 'right=%s/right*.jpg' % boards)
check(first == open(output, 'rb').read(), 'pair: the same bytes again')
report, cameras = calibrate('--columns', '10', '--rows', '7', '--square', '25mm', '--world', 'board',
                            '--leave-out', '0', '--share-lens',
                            'left=%s/left*.jpg' % boards, 'right=%s/right*.jpg' % boards)
centre = [-sum(m[i][2] * m[i][3] for i in range(3)) for m in map(matrix, cameras)]
check(all(0.2 < z < 1 for z in centre), 'board as world: cameras at heights %.3f, %.3f m'
      % tuple(centre))
check(cameras[0]['distortion'] == cameras[1]['distortion'], 'one lens for both')

# The same pictures said to be of a board with another column: no board is found in them.
check('contradict' not in report, 'pair: views agree')
with open(output, encoding='utf-8') as file:
    check(len(file.readlines()) <= 17, 'two cameras, with deviations, in a dozen lines and some')
refused(1, 'found in 0 views', '--output', output, '--columns', '11', '--rows', '7',
        '--square', '25mm', 'left=%s/left*.jpg' % boards)

# Inner corners, as other programs count, in place of squares; a board that is neither.
refused(1, 'so 10 × 7 squares, which is what to give: --columns 10 --rows 7', '--output', output,
        '--columns', '9', '--rows', '6', '--square', '25mm', 'left=%s/left*.jpg' % boards)
refused(1, 'found in 0 views', '--output', output, '--columns', '8', '--rows', '5',
        '--square', '25mm', 'left=%s/left*.jpg' % boards)

# Boards of 14×19 corners that the cameras saw one after the other; two numbers are equal.
apart = ['--columns', '20', '--rows', '15', '--square', '10mm',
         '201=%s/board_201_*.jpg' % multidic, '202=%s/board_202_*.jpg' % multidic]
report, cameras = calibrate('--intrinsics-only', *apart)
check('Intrinsics only' in report and 'board found in 13 of 13' in report,
      'MultiDIC: intrinsics only, RMS %.3f and %.3f px' % tuple(rms(report)[1:3]))
check('the lens is known over 92% of the picture only' in report,
      'MultiDIC: says that no board reached the corners')
check(max(rms(report)[:3]) < 0.3, 'MultiDIC: RMS below 0.3 px')
refused(1, 'taken at the same moment', '--output', output, *apart)

# A film of the boards, not compressed: its frames are as good as the pictures.
film = os.path.join(folder, 'left.avi')
names = [1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14]
for i, n in enumerate(names):
    os.symlink(os.path.join(boards, 'left%02d.jpg' % n), os.path.join(folder, 'left%02d.jpg' % i))
subprocess.run(['gst-launch-1.0', '-q', 'multifilesrc', 'location=' + folder + '/left%02d.jpg',
                'index=0', 'caps=image/jpeg,framerate=5/1', '!', 'jpegdec', '!', 'videoconvert', '!',
                'video/x-raw,format=I420', '!', 'avimux', '!', 'filesink', 'location=' + film],
               check=True, timeout=60)
report, cameras = calibrate('--pattern', pattern, '--every', '1', '--max-views', '10', 'left=' + film)
check('board found in 10 of 13 pictures' in report and rms(report)[0] < 0.18,
      'film: 10 of 13 frames kept, RMS %.3f px' % rms(report)[0])

# Imports.
_, cameras = calibrate('--import-opencv', os.path.join(boards, 'left_intrinsics.yml'))
check(cameras[0]['K'][0][0] == 535.91573396163199 and cameras[0]['name'] == 'left_intrinsics',
      'OpenCV import')
# for root, too, a device stays one
refused(1, 'name a regular file', '--output', '/dev/null', '--import-opencv',
        os.path.join(boards, 'left_intrinsics.yml'))
check(stat.S_ISCHR(os.stat('/dev/null').st_mode), '/dev/null stays')
refused(1, '--size', '--output', output, '--import-opencv', os.path.join(boards, 'intrinsics.yml'))
# 640 and 480 with 2^32 added, and what else only looks like a size.
for size in '4294967936x4294967776', ' 640x480', '640x480x', '+640x480', '640', 'x480', '0x480', '-1x-1':
    refused(2, '--size', '--size', size, '--output', output, '--import-opencv',
            os.path.join(boards, 'intrinsics.yml'))
# A file that doesn't say it, as OpenCV's sample writes them.
unsized = os.path.join(folder, 'unsized.yml')
with open(os.path.join(boards, 'left_intrinsics.yml'), encoding='utf-8') as file:
    text = re.sub('image_(width|height).*\n', '', file.read())
with open(unsized, 'w', encoding='utf-8') as file:
    file.write(text)
_, cameras = calibrate('--size', '641x479', '--import-opencv', unsized)
check(cameras[0]['size'] == [641, 479] and cameras[0]['name'] == 'unsized', '--size')
refused(1, 'no Kalibr camera chain', '--output', output, '--import-kalibr',
        os.path.join(boards, 'left_intrinsics.yml'))
refused(1, 'LENSMODEL', '--output', output, '--import-mrcal', os.path.join(boards, 'left_intrinsics.yml'))
refused(2, 'stand alone', '--output', output, '--import-mrcal', os.path.join(boards, 'left.cameramodel'),
        '--import-kalibr', unsized)
hang = os.path.join(folder, 'hang.yml')
with open(hang, 'w', encoding='utf-8') as file:
    file.write('%YAML:1.0\n---a: 1\nb<!--\nc: 2\n')
refused(1, 'not YAML', '--output', output, '--import-opencv', hang)

# Which way is up: a rig whose y is down, one with the board on the floor, one with a plumb line.
down = os.path.join(folder, 'down.json')
models = [x for side in ('left', 'right') for x in ('--import-mrcal', os.path.join(boards, side + '.cameramodel'))]
check(run('--output', down, *models).returncode == 0, '--import-mrcal')
_, cameras = calibrate('upright', down)
check(all(abs(a - b) < 1e-9 for x, y in zip(cameras[0]['R'], ([1, 0, 0], [0, 0, -1], [0, 1, 0])) for a, b in zip(x, y)),
      'upright: z up in the first picture')
pair = ['--pattern', pattern, 'left=%s/left*.jpg' % boards, 'right=%s/right*.jpg' % boards]
_, floor = calibrate('--world', 'board', *pair)
_, cameras = calibrate('upright', down, '--world', 'board', '--pattern', pattern,
                       'left=%s/left01.jpg' % boards, 'right=%s/right01.jpg' % boards)
off = max(math.dist(a, b) for x, y in zip(floor, cameras) for a, b in zip(matrix(x), matrix(y)))
check(off < 0.01, 'upright on the board: %.4f beside a calibration there' % off)
plumb = os.path.join(folder, 'plumb.csv')
with open(plumb, 'w', encoding='utf-8') as file:
    file.write('# a line that leans by 45° in the pictures\nleft,300,200,0,0,1\nright,240,210,0,0,1\n'
               'left,400,300,0,0,0\nright,340,310,0,0,0\n')
report, cameras = calibrate('upright', down, '--world', 'points', '--points', plumb)
up = [row[2] for row in cameras[0]['R']]
check('(RMS)' in report and up[0] < -0.6 and up[1] < -0.6, 'upright by a plumb line: up is %.2f %.2f %.2f in the camera'
      % tuple(up))
report, cameras = calibrate('--world', 'points', '--points', plumb, *pair)
up = [row[2] for row in cameras[0]['R']]
check('(RMS)' in report and up[0] < -0.6 and up[1] < -0.6, 'calibrated by a plumb line')
refused(2, 'go together', '--output', output, 'upright', down, '--world', 'points')
refused(2, 'go together', '--output', output, 'upright', down, '--points', plumb)
refused(2, 'have no world', '--output', output, '--world', 'points', '--points', plumb, '--intrinsics-only', *pair)
refused(2, 'upright RIG', '--output', output, 'upright')
refused(2, 'upright RIG CAMERA', '--output', output, '--world', 'board', 'upright', down)
refused(2, 'nothing to report', '--output', output, '--report', output, 'upright', down)
refused(1, 'no camera "other"', '--output', output, '--world', 'board', 'upright', down, '--pattern', pattern,
        'other=%s/left01.jpg' % boards)
refused(1, 'in none of the pictures', '--output', output, '--world', 'board', 'upright', down, '--columns', '8',
        '--rows', '5', '--square', '1cm', 'left=%s/left01.jpg' % boards)
with open(plumb, 'a', encoding='utf-8') as file:
    file.write('left,1,2,3\n')
refused(1, 'line 6: give camera,x,y,X,Y,Z', '--output', output, 'upright', down, '--world', 'points', '--points', plumb)

# What can go wrong.
given = ['--output', output, '--pattern', pattern]
left = os.path.join(boards, 'left*.jpg')
broken = os.path.join(folder, 'broken.jpg')
with open(os.path.join(boards, 'left01.jpg'), 'rb') as file, open(broken, 'wb') as half:
    half.write(file.read()[:200])
empty = os.path.join(folder, 'empty.jpg')
open(empty, 'wb').close()
grey = os.path.join(folder, 'grey.png')
subprocess.run(['gst-launch-1.0', '-q', 'videotestsrc', 'num-buffers=1', 'pattern=solid-color', '!',
                'video/x-raw,width=1,height=1', '!', 'videoconvert', '!', 'pngenc', '!', 'filesink',
                'location=' + grey], check=True, timeout=60)
refused(2, '--help', '--output', output)
refused(2, '--output', '--pattern', pattern, 'a=' + left)
refused(2, '--pattern', '--output', output, 'a=' + left)
refused(2, 'not both', *given, '--rows', '7', 'a=' + left)
refused(2, '--square 25', '--output', output, '--columns', '10', '--rows', '7', '--square', '25',
        'a=' + left)
refused(2, '--lens', *given, '--lens', 'wide', 'a=' + left)
refused(2, '--world', *given, '--world', 'moon', 'a=' + left)
refused(2, '--every', *given, '--every', '0', 'a=' + left)
refused(2, 'CAMERA=FILE', *given, left)
refused(2, 'CAMERA=FILE', *given, '=' + left)
refused(2, 'stand alone', *given, '--import-opencv', hang, 'a=' + left)
refused(1, 'no such file', *given, 'a=' + os.path.join(folder, 'missing*.jpg'))
refused(1, 'left02.jpg: it is given twice for camera a', *given, 'a=' + left,
        'a=' + os.path.join(boards, 'left02.jpg'))
refused(1, 'nowhere.json', '--output', output, '--pattern', 'nowhere.json', 'a=' + left)
refused(1, 'does not exist', '--output', os.path.join(folder, 'no', 'rig.json'), '--pattern', pattern,
        'a=' + left)
refused(1, 'found in 1 views', *given, 'a=' + os.path.join(boards, 'left01.jpg'))
refused(1, 'found in 0 views', *given, 'a=' + grey)
refused(1, 'broken.jpg', *given, 'a=' + left, 'a=' + broken)
refused(1, 'empty.jpg', *given, 'a=' + left, 'a=' + empty)
refused(1, 'pattern.json', *given, 'a=' + pattern)
refused(1, 'other pictures of camera a have 640×480', *given, 'a=' + left,
        'a=' + os.path.join(multidic, 'board_201_44.jpg'))
refused(1, 'share no view', *given, 'a=' + os.path.join(boards, 'left0[1-5].jpg'),
        'b=' + os.path.join(boards, 'right0[6-9].jpg'))

for name in os.listdir(folder):
    os.unlink(os.path.join(folder, name))
os.rmdir(folder)
sys.exit(1 if faults else 0)
