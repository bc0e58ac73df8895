#!/usr/bin/python3
"""Whole chains, from files or live sources to meshes and films.

  chains.py CASE DATA      DATA is tests/data

Each case runs gst-launch strings as a user would write them and holds what comes out
against the truth that comes with the data. An exit code proves nothing: frames are
counted.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import importlib.util
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile

import gi
import numpy

gi.require_version('Gst', '1.0')
gi.require_version('GstCloth', '1.0')
from gi.repository import Gst, GstCloth  # noqa: E402

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '../..')
SPEC = importlib.util.spec_from_file_location(
    'compare_truth', os.path.join(ROOT, 'pipelines/compare-truth.py'))
compare_truth = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(compare_truth)

TIMEOUT_S = 150
FRAMES = 63


class Failure(Exception):
    """What did not hold."""


def check(condition, text):
    print('%s: %s' % ('ok' if condition else 'NOT OK', text))
    if not condition:
        raise Failure(text)


def run(description, on_buffer=None, posted=None, feed=None):
    """Plays a pipeline to its end. Every appsink feeds on_buffer (name, buffer, caps); the texts of element
    messages go into posted, by name; feed has what appsrcs send, by name. Returns how many buffers each got, the error if
    there was one, and the warnings."""
    print('gst-launch-1.0 ' + description)
    pipeline = Gst.parse_launch(description)
    counts = {}

    def take(sink):
        sample = sink.emit('pull-sample')
        if sample:
            counts[sink.get_name()] = counts.get(sink.get_name(), 0) + 1
            if on_buffer:
                on_buffer(sink.get_name(), sample.get_buffer(), sample.get_caps())
        return Gst.FlowReturn.OK

    iterator = pipeline.iterate_recurse()
    while True:
        result, element = iterator.next()
        if result != Gst.IteratorResult.OK:
            break
        if element.get_factory().get_name() == 'appsink':
            element.set_property('emit-signals', True)
            element.set_property('sync', False)
            counts[element.get_name()] = 0
            element.connect('new-sample', take)

    bus = pipeline.get_bus()
    pipeline.set_state(Gst.State.PLAYING)
    for name, buffers in (feed or {}).items():
        source = pipeline.get_by_name(name)
        for buffer in buffers:
            source.emit('push-buffer', buffer)
        source.emit('end-of-stream')
    warnings = []
    while True:
        message = bus.timed_pop_filtered(TIMEOUT_S * Gst.SECOND, Gst.MessageType.EOS
                                         | Gst.MessageType.ERROR | Gst.MessageType.WARNING
                                         | Gst.MessageType.ELEMENT)
        if message is not None and message.type == Gst.MessageType.ELEMENT:
            if posted is not None:
                posted[message.get_structure().get_name()] = message.get_structure().to_string().replace('\\', '')
            continue
        if message is None or message.type != Gst.MessageType.WARNING:
            break
        warnings.append(message.parse_warning().gerror.message)
        print('warning: ' + warnings[-1])
    error = None
    if message is None:
        error = 'neither an end nor an error within %d s' % TIMEOUT_S
    elif message.type == Gst.MessageType.ERROR:
        error = message.parse_error().gerror.message
    check(pipeline.set_state(Gst.State.NULL) == Gst.StateChangeReturn.SUCCESS, 'it stops')
    return counts, error, warnings


def play(description, on_buffer=None, posted=None, feed=None):
    counts, error, _ = run(description, on_buffer, posted, feed)
    check(error is None, 'it runs to its end' + (': ' + error if error else ''))
    return counts


class Pair:
    """The rendered cloth: two cameras, the truth of every vertex."""

    def __init__(self, data):
        self.folder = os.path.join(data, 'checker_pair')
        with open(os.path.join(self.folder, 'pattern.json'), encoding='utf-8') as file:
            self.pattern = json.load(file)
        with open(os.path.join(self.folder, 'rig.json'), encoding='utf-8') as file:
            self.cameras = {c['name']: c for c in json.load(file)['cameras']}
        truth = numpy.load(os.path.join(self.folder, 'vertices.npy'))
        self.corners = compare_truth.true_corners(truth, 33, 35, self.pattern)

    def film(self, camera):
        return ('filesrc location=%s/%s.mp4 ! qtdemux ! h264parse ! avdec_h264'
                % (self.folder, camera))

    def track(self, camera):
        return ('saddledetect ! quadtrack pattern=%s/pattern.json camera=%s'
                % (self.folder, camera))

    def join(self, *settings):
        return ('triangulate name=join rig=%s/rig.json pattern=%s/pattern.json %s'
                % (self.folder, self.folder, ' '.join(settings)))

    def seen(self, camera):
        """[frames][vertices][2]: where the camera truly sees the corners, px."""
        c = self.cameras[camera]
        x = self.corners @ numpy.array(c['R']).T + numpy.array(c['t'])
        x = x @ numpy.array(c['K']).T
        return x[..., :2] / x[..., 2:]

    def quad_errors(self, camera, frame, quads):
        """Of each tracked square: its index, the distances of its four corners from
        their true places, px, and whether it lies rather on another square."""
        truth = self.seen(camera)[frame].reshape(self.pattern['rows'] + 1, -1, 2)
        squares = numpy.stack([truth[:-1, :-1], truth[:-1, 1:], truth[1:, 1:], truth[1:, :-1]], 2)
        found = []
        for n in range(quads.get_n_quads()):
            ok, quad = quads.get_quad(n)
            if not ok or quad.state != GstCloth.QuadState.TRACKED:
                continue
            corners = numpy.stack([list(quad.x), list(quad.y)], 1)
            distance = numpy.linalg.norm(squares - corners, axis=3)
            each = numpy.sqrt((distance ** 2).mean(axis=2))
            own = each[quad.row, quad.column]
            # Turned squares count as well: the corners of a square in another order.
            turned = min(numpy.sqrt((numpy.linalg.norm(
                squares[quad.row, quad.column] - numpy.roll(corners, turn, 0), axis=1) ** 2)
                .mean()) for turn in (1, 2, 3))
            each[quad.row, quad.column] = turned
            found.append(((quad.column, quad.row), distance[quad.row, quad.column],
                          own > 4 and each.min() < own / 2))
        return found


def case_pair(data):
    """Two films to a mesh: 63 frames, 0.9 mm, and no corner mistaken."""
    pair = Pair(data)
    with tempfile.TemporaryDirectory() as folder:
        play('%s ! tee name=mesh  mesh. ! queue ! meshsink location=%s/cloth.obj'
             '  mesh. ! queue ! meshsink location=%s/take format=take'
             '  %s ! %s ! queue ! join.  %s ! %s ! queue ! join.'
             % (pair.join(), folder, folder, pair.film('cam0'), pair.track('cam0'),
                pair.film('cam1'), pair.track('cam1')))
        positions = numpy.load(folder + '/take/positions.npy')
        check(positions.shape == (FRAMES, 81, 3), 'positions %s' % (positions.shape,))
        for name in ('cloth.obj', 'cloth.pc2'):
            check(os.path.getsize(os.path.join(folder, name)) > 100, name + ' is there')
        sys.argv = ['compare-truth', folder + '/take', '--truth', pair.folder + '/vertices.npy',
                    '--grid', '33x35', '--pattern', pair.folder + '/pattern.json',
                    '--max-rms-mm', '0.9']
        check(compare_truth.main() == 0, 'within the limits')


def case_overlay(data):
    """What is drawn into a film changes it, and its frames stay all there."""
    pair = Pair(data)
    pictures = {'plain': [], 'drawn': []}

    def keep(name, buffer, caps):
        ok, view = buffer.map(Gst.MapFlags.READ)
        pictures[name].append(numpy.frombuffer(view.data, numpy.uint8).copy())
        buffer.unmap(view)

    play('%s ! tee name=t  t. ! queue ! videoconvert ! video/x-raw,format=RGB ! appsink name=plain'
         '  t. ! queue ! %s ! clothoverlay ! videoconvert ! video/x-raw,format=RGB'
         ' ! appsink name=drawn' % (pair.film('cam0'), pair.track('cam0')), keep)
    check(len(pictures['plain']) == len(pictures['drawn']) == FRAMES, 'all frames')
    changed = [(a != b).mean() for a, b in zip(pictures['plain'], pictures['drawn'])]
    check(min(changed) > 0.002, 'each is drawn on (least %.2f%% of the bytes)' % (100 * min(changed)))
    check(max(changed) < 0.5, 'the picture stays visible (most %.2f%%)' % (100 * max(changed)))


def case_encoded(data):
    """The metadata outlives conversion, an encoder and a decoder."""
    pair = Pair(data)
    found = []

    def keep(name, buffer, caps):
        quads = GstCloth.buffer_get_cloth_quads(buffer)
        found.append(0 if quads is None else quads.get_n_quads())

    play('%s ! %s ! tee ! queue ! videoconvert ! jpegenc ! jpegdec ! appsink name=sink'
         % (pair.film('cam0'), pair.track('cam0')), keep)
    check(len(found) == FRAMES and min(found) > 10, 'squares in each frame, least %d' % min(found))


def case_boards(data):
    """Real pictures of a board, one after the other: each is a new start."""
    boards = os.path.join(data, 'opencv_boards')
    for side in ('left', 'right'):
        names = sorted(n for n in os.listdir(boards) if n.startswith(side) and n.endswith('.jpg'))
        check(len(names) == 13, '13 pictures')
        for name in names:
            found = []

            def keep(sink, buffer, caps):
                quads = GstCloth.buffer_get_cloth_quads(buffer)
                found.append(0 if quads is None else quads.get_n_quads())

            play('filesrc location=%s/%s ! jpegdec ! video/x-raw,format=GRAY8 ! saddledetect'
                 ' ! quadtrack pattern=%s/pattern.json ! appsink name=sink'
                 % (boards, name, boards), keep)
            # 10 × 7 squares, half of them black; the paper's edge cuts those at the sides.
            check(found and found[0] >= 33, '%s: %s squares' % (name, found))


def case_live(data):
    """A live camera: every frame comes out, and on time."""
    count = play('videotestsrc is-live=true pattern=checkers-8 num-buffers=20'
                 ' ! video/x-raw,format=I420,width=322,height=240,framerate=25/1 ! saddledetect'
                 ' ! quadtrack pattern=%s/checker_pair/pattern.json ! clothoverlay'
                 ' ! videoconvert ! appsink name=sink' % data)
    check(count['sink'] == 20, '%d frames of 20' % count['sink'])


def case_live_pair(data):
    """Two live cameras that see no board: meshes without points, on time, no hang."""
    pair = Pair(data)
    camera = ('videotestsrc is-live=true num-buffers=20 ! video/x-raw,format=GRAY8,width=752,'
              'height=480,framerate=25/1 ! %s ! queue ! join.')
    count = play('%s ! appsink name=sink  %s  %s'
                 % (pair.join(), camera % pair.track('cam0'), camera % pair.track('cam1')))
    check(count['sink'] >= 15, '%d meshes' % count['sink'])


def case_realtime(data):
    """Two films in real time: what the meshes lack is told, and nothing lacks where nothing is told.
    Then one camera comes half a second late, which is more than `latency` waits."""
    pair = Pair(data)
    for late in (False, True):
        empty = [0]

        def keep(name, buffer, caps):
            mesh = GstCloth.Mesh.from_buffer(buffer)
            points = numpy.frombuffer(mesh.get_points().get_data(), numpy.float32)
            empty[0] += not numpy.isfinite(points).any()

        counts, error, warnings = run(
            '%s ! appsink name=sink  %s ! identity sync=true ! %s ! queue ! join.'
            '  %s ! identity sync=true ts-offset=%d ! %s ! queue ! join.'
            % (pair.join(), pair.film('cam0'), pair.track('cam0'), pair.film('cam1'),
               500000000 * late, pair.track('cam1')), keep)
        told = [w for w in warnings if 'sets lacked a picture' in w]
        check(error is None and counts['sink'] > 0, '%d meshes, %d empty: %s' % (counts['sink'], empty[0], told))
        check(bool(told) == (empty[0] > 0), 'told where meshes are empty, and only there')
        if late:
            check(empty[0] > 10 and 'camera "cam1"' in told[0] and any(
                'camera "cam1"' in w and 'too late' in w for w in warnings if w not in told),
                  'the late camera is named')


def case_silent(data):
    """A camera that never gives anything is told of by each element that joins streams, under its name."""
    films = os.path.join(data, 'lineart_stereo3')
    camera = ('videotestsrc is-live=true num-buffers=60 ! video/x-raw,format=GRAY8,width=%d,height=%d,'
              'framerate=25/1 ! valve drop=%d drop-mode=forward-sticky-events ! %s')
    pair = Pair(data)
    disparity = 'clothdisparity name=%s rig=' + films + '/rig.json sink_0::camera=cam0 sink_1::camera=cam1'
    for what, description in (
            ('triangulate', '%s ! fakesink  %s  %s' % (
                pair.join(), camera % (752, 480, 0, pair.track('cam0') + ' ! join.'),
                camera % (752, 480, 1, pair.track('cam1') + ' ! join.'))),
            ('clothdisparity', '%s ! fakesink  %s  %s' % (
                disparity % 'head', camera % (1024, 768, 0, 'head.sink_0'), camera % (1024, 768, 1, 'head.sink_1')))):
        pipeline = Gst.parse_launch(description)
        bus = pipeline.get_bus()
        pipeline.set_state(Gst.State.PLAYING)
        told = []
        while True:
            message = bus.timed_pop_filtered(TIMEOUT_S * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR
                                             | Gst.MessageType.ELEMENT)
            if message is None or message.type != Gst.MessageType.ELEMENT:
                break
            told.append(message.get_structure().get_name())
        pipeline.set_state(Gst.State.NULL)
        check(message is not None and message.type == Gst.MessageType.EOS and what + '/silent' in told,
              '%s: %s' % (what, sorted(set(told))))


def case_fit(data):
    """A mesh with a large hole from the first frame on, of another program's cloth: the simulated cloth is
    half as far off there as what is filled in, and whole."""
    with tempfile.TemporaryDirectory() as folder:
        hidden, whole, filled = (os.path.join(folder, name) for name in ('hidden', 'whole', 'filled'))
        shutil.copytree(os.path.join(data, 'arcsim/base'), hidden)
        truth = numpy.load(hidden + '/positions.npy')
        seen = truth.copy()
        seen.reshape(-1, 35, 33, 3)[:, 12:30, 8:24] = numpy.nan
        numpy.save(hidden + '/positions.npy', seen)
        play('meshsrc location=%s ! tee name=t  t. ! queue ! meshfill ! meshsink location=%s format=take'
             '  t. ! queue ! clothfit model=%s/arcsim/model.json location=%s'
             ' ! meshsink location=%s format=take' % (hidden, filled, data, hidden, whole))
        lost = numpy.isnan(seen[:, :, 0]) & numpy.isfinite(truth[:, :, 0])
        # what the springs have not reached yet
        lost[:10] = False
        off = {}
        for take in (whole, filled):
            places = numpy.load(take + '/positions.npy')
            off[take] = 1e3 * numpy.sqrt((numpy.linalg.norm(places - truth, axis=2)[lost] ** 2).mean())
        check(lost.mean() > 0.2 and off[whole] < 8 and off[whole] < off[filled] / 2,
              'hidden vertices: fitted %.1f mm RMS off, filled %.1f' % (off[whole], off[filled]))
        states = numpy.load(whole + '/states.npy')
        check(numpy.isfinite(numpy.load(whole + '/positions.npy')).all() and set(numpy.unique(states)) == {1, 4},
              'measured or predicted, no holes')


def case_fit_film(data):
    """One camera's film of a sheet that air holds back, and a model whose fabric is wrong: from what is seen
    across the sight its stiffnesses are found, or are told not to be known."""
    posted = {}
    with tempfile.TemporaryDirectory() as folder:
        with open(folder + '/rig.json', 'w', encoding='utf-8') as file:
            json.dump({'version': 1, 'cameras': [{
                'name': 'left', 'size': [640, 480], 'K': [[900, 0, 319.5], [0, 900, 239.5], [0, 0, 1]],
                'distortion': {'model': 'none', 'coefficients': []},
                'R': [[0.6, 0.8, 0], [0, 0, -1], [-0.8, 0.6, 0]], 't': [-0.114, 1.3, 1.352]}]}, file)
        with open(folder + '/pattern.json', 'w', encoding='utf-8') as file:
            json.dump({'version': 1, 'pattern': 'checker', 'columns': 8, 'rows': 8, 'square_m': 0.05,
                       'origin_uv_m': [0, 0], 'cloth_m': [0.4, 0.4], 'first_square': 'black'}, file)
        with open(os.path.join(ROOT, 'pipelines/model-knit.json'), encoding='utf-8') as file:
            model = json.load(file)
        true = model['stretch']['warp'], model['stretch']['weft'], model['shear']
        model['stretch'], model['shear'] = {'warp': 50, 'weft': 200}, 20
        with open(folder + '/wrong.json', 'w', encoding='utf-8') as file:
            json.dump(model, file)
        play('meshsrc location=%s/take_drag ! clothcamera rig=%s/rig.json pattern=%s/pattern.json ! saddledetect'
             ' ! quadtrack pattern=%s/pattern.json ! clothmetapay ! clothfit model=%s/wrong.json rig=%s/rig.json'
             ' location=%s/take_drag fitted=%s/fitted.json ! meshsink location=%s/whole.take'
             % (data, folder, folder, folder, folder, folder, data, folder, folder), posted=posted)
        with open(folder + '/fitted.json', encoding='utf-8') as file:
            fitted = json.load(file)
        found = fitted['stretch']['warp'], fitted['stretch']['weft'], fitted['shear']
        sigmas = {name: float(sigma) for name, sigma in re.findall(
            r'name=\(string\)([a-z.]+), [^;]*? sigma=\(double\)([^,]+)', posted['clothfit/fitted'])}
        known = 0
        for name, value, truth in zip(('stretch.warp', 'stretch.weft', 'shear'), found, true):
            is_known = sigmas[name] < 0.2 * value
            known += is_known
            check(abs(value - truth) < (0.2 * truth if is_known else 2 * sigmas[name]),
                  '%s %.1f ± %.1f, truly %g' % (name, value, sigmas[name], truth))
        check(known >= 2, '%d of 3 are known to a fifth' % known)
        truth = numpy.load(os.path.join(data, 'take_drag/positions.npy'))
        off = 1e3 * numpy.sqrt((numpy.linalg.norm(numpy.load(folder + '/whole.take/positions.npy') - truth, axis=2)
                                ** 2).mean())
        check(off < 15, 'the cloth drawn across the sight is %.1f mm RMS off, with the model as it was' % off)


class Head:
    """Three cameras about the swinging sheet of take_drag, as a pinhole has its corners, with noise. The lower rows are seen by
    the first camera alone. The second one's clock is ahead, and its pictures are a little late."""
    POSES = {
        'left': ([[0.6, 0.8, 0], [0, 0, -1], [-0.8, 0.6, 0]], [-0.114, 1.3, 1.352]),
        'right': ([[0.6, -0.8, 0], [0, 0, -1], [0.8, 0.6, 0]], [-0.114, 1.3, 1.048]),
        'front': ([[1, 0, 0], [0, 0, -1], [0, 1, 0]], [-0.19, 1.3, 1.2])}
    K = [[900, 0, 319.5], [0, 900, 239.5], [0, 0, 1]]
    OFFSET_S = {'left': 0, 'right': 0.004, 'front': 0}
    LATE_S = {'left': 0, 'right': 0.0001, 'front': 0}
    ROWS = 4
    SIGMA = 0.05

    def __init__(self, data, folder):
        self.take, self.folder = os.path.join(data, 'take_drag'), folder
        self.rig, self.pattern = folder + '/rig.json', folder + '/pattern.json'
        self.truth = numpy.load(self.take + '/positions.npy')
        random = numpy.random.RandomState(1)
        self.packets = {name: [self.see(name, frame, random) for frame in range(len(self.truth))] for name in self.POSES}
        with open(self.rig, 'w', encoding='utf-8') as file:
            json.dump({'version': 1, 'cameras': [{
                'name': name, 'size': [640, 480], 'K': self.K, 'distortion': {'model': 'none', 'coefficients': []},
                'R': R, 't': t, 'offset_s': self.OFFSET_S[name]} for name, (R, t) in self.POSES.items()]}, file)
        with open(self.pattern, 'w', encoding='utf-8') as file:
            json.dump({'version': 1, 'pattern': 'checker', 'columns': 8, 'rows': 8, 'square_m': 0.05,
                       'origin_uv_m': [0, 0], 'cloth_m': [0.4, 0.4], 'first_square': 'black'}, file)

    def see(self, name, frame, random):
        R, t = self.POSES[name]
        share = 50 * self.LATE_S[name]
        truth = (1 - share) * self.truth[frame] + share * self.truth[min(frame + 1, len(self.truth) - 1)]
        places = truth @ numpy.transpose(R) + t
        px = (places / places[:, 2:]) @ numpy.transpose(self.K)[:, :2] + self.SIGMA * random.randn(81, 2)
        quads = []
        for i in range(64 if name == 'left' else 8 * self.ROWS):
            quad = GstCloth.Quad()
            quad.column, quad.row, quad.state, quad.confidence = i % 8, i // 8, GstCloth.QuadState.TRACKED, 1
            for corner, (column, row) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
                x, y = px[9 * (quad.row + row) + quad.column + column]
                quad.set_corner(corner, x, y, self.SIGMA ** 2, 0, self.SIGMA ** 2)
            quads.append(quad)
        picture = Gst.Buffer.new()
        picture.pts = round((frame / 50 + self.OFFSET_S[name] + self.LATE_S[name]) * Gst.SECOND)
        picture.duration = Gst.SECOND // 50
        GstCloth.buffer_add_cloth_quads_meta(picture, GstCloth.Quads.new(name, frame, 8, 8, quads))
        return GstCloth.observations_pack(picture)

    def record(self, folder):
        """A take of what the cameras saw, with nothing else but where it starts."""
        os.makedirs(folder + '/observations')
        for name in 'take.json', 'clamps.npy':
            shutil.copy(os.path.join(self.take, name), folder)
        shutil.copy(self.rig, folder)
        numpy.save(folder + '/positions.npy', self.truth[:1])
        numpy.save(folder + '/times.npy', numpy.arange(len(self.truth)) / 50)
        for name, packets in self.packets.items():
            with open('%s/observations/%s.obs' % (folder, name), 'wb') as file:
                for packet in packets:
                    file.write(packet.extract_dup(0, packet.get_size()))

    def join(self):
        return ''.join(' appsrc name=%s format=time max-bytes=0 caps="application/x-cloth-observations, version=1, width=640,'
                       ' height=480, framerate=50/1" ! join.' % name for name in self.POSES) + \
            ' triangulate name=join rig=%s pattern=%s' % (self.rig, self.pattern)

    def play(self, rest, posted=None):
        return play(self.join() + rest, posted=posted, feed=self.packets)


def tool(*arguments):
    result = subprocess.run([os.path.join(os.environ['CLOTH_BUILD'], 'tools', arguments[0]), *arguments[1:]],
                            capture_output=True, text=True, timeout=TIMEOUT_S, check=False)
    check(result.returncode == 0, ' '.join(arguments[:2]) + (result.stderr if result.returncode else ''))


def read_gap(text):
    """A diagnosis but for how long it took and for what was written of its recording."""
    gap = json.loads(text)
    for key in 'seconds', 'inputs':
        gap.pop(key)
    return gap


def case_cameras(data):
    """What three cameras see of a sheet, live: what one of them alone sees counts, and the fit and the diagnosis are those of
    the tools on a take of the same cameras."""
    with tempfile.TemporaryDirectory() as folder:
        head, off, posted = Head(data, folder), {}, {}
        head.record(folder + '/seen')
        with open(os.path.join(ROOT, 'pipelines/model-knit.json'), encoding='utf-8') as file:
            model = json.load(file)
        model['stretch'], model['shear'], model['free'] = {'warp': 50, 'weft': 200}, 20, model['free'][:3]
        with open(folder + '/wrong.json', 'w', encoding='utf-8') as file:
            json.dump(model, file)
        fit = ' ! clothfit model=%s/wrong.json location=%s' % (folder, head.take)
        head.play(' ! meshsink location=%s/mesh.take' % folder)
        head.play(fit + ' rig=%s fitted=%s/live.json ! meshsink location=%s/rays.take' % (head.rig, folder, folder))
        head.play(fit + ' ! meshsink location=%s/places.take' % folder)
        lone = numpy.isnan(numpy.load(folder + '/mesh.take/positions.npy')[:, :, 0])
        check(0.4 < lone.mean() < 0.5, '%.0f%% of the vertices are on no mesh' % (100 * lone.mean()))
        for name in 'rays', 'places':
            places = numpy.load('%s/%s.take/positions.npy' % (folder, name))
            off[name] = 1e3 * numpy.sqrt((numpy.linalg.norm(places - head.truth, axis=2)[lone] ** 2).mean())
            states = numpy.load('%s/%s.take/states.npy' % (folder, name))
            check((states[:, 45:] == (1 if name == 'rays' else 4)).all(), 'the lower rows are measured, or else predicted')
        check(off['rays'] < off['places'] / 2,
              'they are %.1f mm RMS off, without the rays %.1f' % (off['rays'], off['places']))
        tool('gst-cloth-fit-1.0', 'fit', folder + '/seen', '--model', folder + '/wrong.json', '--output', folder + '/tool')
        with open(folder + '/live.json', 'rb') as live, open(folder + '/tool/fitted.json', 'rb') as of_take:
            check(live.read() == of_take.read(), 'fitted.json has the same bytes')

        knit = os.path.join(ROOT, 'pipelines/model-knit.json')
        head.play(' ! clothgap model=%s location=%s rig=%s effects=air_drag,wind output=%s/gap ! fakesink'
                  % (knit, head.take, head.rig, folder), posted)
        check('clothgap/score' in posted and 'clothgap/verdict' in posted, 'scores and a verdict')
        tool('gst-cloth-gap-1.0', 'diagnose', folder + '/seen', '--model', knit, '--effects', 'air_drag,wind', '--output',
             folder + '/gap-tool')
        with open(folder + '/gap/gap.json', encoding='utf-8') as live, \
                open(folder + '/gap-tool/gap.json', encoding='utf-8') as of_take:
            live, of_take = read_gap(live.read()), read_gap(of_take.read())
        check(live == of_take, 'gap.json says the same: %s, %s' % (live['verdict'], [e['name'] for e in live['effects'][:2]]))


def case_early_end(data):
    """One camera ends after 20 frames: the mesh ends in order, nothing hangs."""
    pair = Pair(data)
    count = play('%s ! appsink name=sink  %s ! %s ! queue ! join.'
                 '  %s ! identity eos-after=21 ! %s ! queue ! join.'
                 % (pair.join(), pair.film('cam0'), pair.track('cam0'),
                    pair.film('cam1'), pair.track('cam1')))
    check(count['sink'] >= 20, '%d meshes' % count['sink'])


def case_cuts(data):
    """A film with cuts and a black stretch: the right squares, or none."""
    pair = Pair(data)
    # The order in which the frames of the film are shown; −1 is black.
    order = list(range(0, 15)) + [-1] * 5 + list(range(30, 45)) + list(range(5, 15)) \
        + [-1] * 2 + list(range(50, 63))
    frames = []

    def keep(name, buffer, caps):
        ok, view = buffer.map(Gst.MapFlags.READ)
        frames.append(bytes(view.data))
        buffer.unmap(view)

    play('%s ! videoconvert ! video/x-raw,format=GRAY8 ! appsink name=sink' % pair.film('cam0'),
         keep)
    check(len(frames) == FRAMES, 'all frames')
    black = bytes([16]) * len(frames[0])
    seen = []

    def look(name, buffer, caps):
        frame = order[len(seen)]
        quads = GstCloth.buffer_get_cloth_quads(buffer)
        found = pair.quad_errors('cam0', frame, quads) if quads and frame >= 0 else []
        tracked = 0
        for n in range(quads.get_n_quads() if quads else 0):
            tracked += quads.get_quad(n)[1].state == GstCloth.QuadState.TRACKED
        seen.append((frame, tracked, found))

    with tempfile.TemporaryDirectory() as folder:
        with open(folder + '/cut.gray', 'wb') as file:
            for frame in order:
                file.write(black if frame < 0 else frames[frame])
        play('filesrc location=%s/cut.gray ! rawvideoparse format=gray8 width=752 height=480'
             ' framerate=25/1 ! %s ! appsink name=sink' % (folder, pair.track('cam0')), look)
    check(len(seen) == len(order), 'all frames')
    starts = [n for n in range(len(order)) if order[n] >= 0
              and (n == 0 or order[n] != order[n - 1] + 1)]
    wrong = [(n, index) for n, (_, _, found) in enumerate(seen)
             for index, _, other in found if other]
    check(not wrong, 'no wrong index (frame, square: %s)' % wrong)
    ghosts = [n for n, (frame, tracked, _) in enumerate(seen) if frame < 0 and tracked]
    check(not ghosts, 'nothing tracked on black (frames %s)' % ghosts)
    for start in starts:
        counts = [seen[n][1] for n in range(start, min(start + 5, len(seen)))]
        check(max(counts) >= 25, 'within 5 frames of frame %d again: %s squares' % (start, counts))
    errors = numpy.concatenate([d for _, _, found in seen for _, d, _ in found])
    print('corners: median %.3f px, 95%% within %.3f px, largest %.2f px'
          % (numpy.median(errors), numpy.percentile(errors, 95), errors.max()))
    check(numpy.median(errors) < 0.2, 'half of the corners lie within 0.2 px')


def case_bad(data):
    """What is wrong is said, and stops the pipeline."""
    pair = Pair(data)
    chain = 'videotestsrc num-buffers=5 ! video/x-raw,format=GRAY8,width=64,height=48 ! '
    for description, word in (
            (chain + 'saddledetect ! quadtrack pattern=/nowhere/pattern.json ! fakesink',
             'pattern'),
            (chain + 'saddledetect ! quadtrack pattern=%s/rig.json ! fakesink' % pair.folder,
             'pattern'),
            ('triangulate name=join rig=/nowhere/rig.json ! fakesink  %s %s ! join.'
             % (chain, pair.track('cam0')), 'rig'),
            ('triangulate name=join ! fakesink  %s %s ! join.' % (chain, pair.track('cam0')),
             'rig'),
            ('%s ! fakesink  %s %s ! join.' % (pair.join(), chain, pair.track('nobody')),
             'camera')):
        _, error, _ = run(description)
        check(error is not None and word in error.lower(), 'error: %s' % error)


def dots_to_mesh(data, folder, pattern):
    """The script's exit code and all that it says."""
    ring = os.path.join(data, 'dots_ring8')
    films = ['cam%d=%s/cam%d.mp4' % (n, ring, n) for n in range(8)]
    done = subprocess.run([os.path.join(ROOT, 'pipelines/dots-to-mesh.sh'),
                           ring + '/rig8.json', pattern, os.path.join(folder, 'garment'),
                           *films], timeout=TIMEOUT_S,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    print(done.stdout.decode())
    return done.returncode, done.stdout.decode()


def case_print_script(data):
    """print-to-mesh.sh calls no empty mesh done: with the picture of another print, a photograph of a
    plant, it says that it isn't the one filmed."""
    films = os.path.join(data, 'lineart_stereo3')
    with open(os.path.join(films, 'pattern.json'), encoding='utf-8') as file:
        pattern = json.load(file)
    pattern.update(reference='aloeL.jpg', cloth_m=[0.641, 0.555])
    with tempfile.TemporaryDirectory() as folder:
        with open(folder + '/pattern.json', 'w', encoding='utf-8') as file:
            json.dump(pattern, file)
        shutil.copy(os.path.join(data, 'aloe/aloeL.jpg'), folder)
        done = subprocess.run([os.path.join(ROOT, 'pipelines/print-to-mesh.sh'), films + '/rig.json',
                               folder + '/pattern.json', folder + '/cloth',
                               'cam0=%s/cam0.mp4' % films, 'cam1=%s/cam1.mp4' % films],
                              timeout=TIMEOUT_S, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              check=False)
        text = done.stdout.decode()
        print(text)
        check(done.returncode == 1, 'exit code %d' % done.returncode)
        check('Hardly anything of the film is found in the print' in text, 'the warning is passed on')
        check('nothing of the print was located' in text, 'it says so')
        check(not os.path.exists(folder + '/cloth/cloth.obj'), 'no file to import of an empty mesh')
        done = subprocess.run([os.path.join(ROOT, 'pipelines/print-to-mesh.sh'), films + '/rig.json',
                               films + '/pattern.json', folder + '/cloth', 'cam0=/nowhere.mp4',
                               'cam1=%s/cam1.mp4' % films], timeout=TIMEOUT_S, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        check(done.returncode == 2 and b'write CAMERA=FILE' in done.stdout, 'a film that is not there')


def turned_film(film, path):
    """A film as a phone stores it: three pictures turned to the left, and a matrix that says so."""
    folder = os.path.dirname(path)
    # pictures by number, since a decoder gives more behind the end of a stream
    subprocess.run(['gst-launch-1.0', '-q', *('filesrc location=%s ! decodebin ! videoconvert ! videoflip '
                                              'video-direction=90l ! jpegenc quality=98 ! multifilesink '
                                              'location=%s/%%d.jpg' % (film, folder)).split()],
                   timeout=TIMEOUT_S, check=True)
    subprocess.run(['gst-launch-1.0', '-q', *('multifilesrc location=%s/%%d.jpg stop-index=2 '
                                              'caps=image/jpeg,framerate=25/1 ! jpegdec ! jpegenc quality=98 ! qtmux '
                                              '! filesink location=%s' % (folder, path)).split()],
                   timeout=TIMEOUT_S, check=True)
    with open(path, 'rb') as file:
        movie = file.read()
    head = movie.index(b'tkhd')
    upright = struct.pack('>9i', 1 << 16, 0, 0, 0, 1 << 16, 0, 0, 0, 1 << 30)
    at = movie.index(upright, head)
    check(at < head + 100, "the track's matrix")
    turned = struct.pack('>9i', 0, 1 << 16, 0, -1 << 16, 0, 0, 0, 0, 1 << 30)
    with open(path, 'wb') as file:
        file.write(movie[:at] + turned + movie[at + len(upright):])


def case_print_turned(data):
    """print-to-mesh.sh takes films that are stored turned, one beside one that is not."""
    films = os.path.join(data, 'lineart_stereo3')
    with tempfile.TemporaryDirectory() as folder:
        turned_film(films + '/cam0.mp4', folder + '/phone.mov')
        done = subprocess.run([os.path.join(ROOT, 'pipelines/print-to-mesh.sh'), films + '/rig.json',
                               films + '/pattern.json', folder + '/cloth', 'cam0=%s/phone.mov' % folder,
                               'cam2=%s/cam2.mp4' % films], timeout=TIMEOUT_S, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        print(done.stdout.decode())
        check(done.returncode == 0, 'exit code %d' % done.returncode)
        with open(folder + '/cloth/cloth.take/states.npy', 'rb') as file:
            states = file.read()[128:]
        # where both films have pictures
        measured = [states[n:n + 33 * 35].count(2) / (33 * 35) for n in range(0, 3 * 33 * 35, 33 * 35)]
        check(min(measured) > 0.8, 'measured of each frame: %s' % measured)


def case_shortened(data):
    """A pipeline that is cut behind the join has the film's first frames without a hole, though the decoder
    has more pictures when the end comes; and no document cuts right behind a decoder."""
    pair = os.path.join(data, 'checker_pair')
    with tempfile.TemporaryDirectory() as folder:
        branches = ' '.join('filesrc location=%s/%s.mp4 ! decodebin ! videoconvert ! saddledetect '
                            '! quadtrack pattern=%s/pattern.json camera=%s ! queue ! join.'
                            % (pair, name, pair, name) for name in ('cam0', 'cam1'))
        subprocess.run(['gst-launch-1.0', '-q', *('triangulate name=join rig=%s/rig.json pattern=%s/pattern.json '
                                                  '! identity eos-after=7 ! meshsink location=%s/short.take %s'
                                                  % (pair, pair, folder, branches)).split()],
                       timeout=TIMEOUT_S, check=True)
        with open(folder + '/short.take/times.npy', 'rb') as file:
            times = struct.unpack('<6d', file.read()[128:])
        steps = [b - a for a, b in zip(times, times[1:])]
        check(max(steps) - min(steps) < 1e-6 and max(steps) < 0.05, 'times: %s' % (times,))
    for name in sorted(os.listdir(os.path.join(ROOT, 'docs'))):
        if name.endswith('.md'):
            with open(os.path.join(ROOT, 'docs', name), encoding='utf-8') as file:
                check(not re.search(r'(decodebin|avdec_\w+)( ! videoconvert)?\s(\\\n\s*)?! identity eos-after',
                                    file.read()), name + ' cuts no film behind its decoder')


def case_dots_script(data):
    """dots-to-mesh.sh passes warnings on, and calls no empty mesh done."""
    ring = os.path.join(data, 'dots_ring8')
    with open(os.path.join(ring, 'pattern.json'), encoding='utf-8') as file:
        pattern = json.load(file)
    swapped, other = dict(pattern), dict(pattern)
    for key in ('colours', 'rgb'):
        swapped[key] = [pattern[key][k] for k in (0, 3, 2, 1, 4)]
    other['matrix'] = [[(k + 1) % 5 for k in row] for row in pattern['matrix'][::-1]]
    for what, code, words in (
            (swapped, None, 'orange look magenta and the other way round'),
            (other, 1, 'no dot was located')):
        with tempfile.TemporaryDirectory() as folder:
            with open(folder + '/pattern.json', 'w', encoding='utf-8') as file:
                json.dump(what, file)
            found, text = dots_to_mesh(data, folder, folder + '/pattern.json')
            check(words in text, 'it says: ' + words)
            check(code is None or found == code, 'exit code %d' % found)
            check(code is None or not os.path.exists(folder + '/garment/cloth.obj'),
                  'no files to import of an empty mesh')


def case_dots_summary(data):
    """dots-to-mesh.sh ends with what was found, by camera and of the mesh, and it is what the take says."""
    ring = os.path.join(data, 'dots_ring8')
    with tempfile.TemporaryDirectory() as folder:
        code, text = dots_to_mesh(data, folder, ring + '/pattern.json')
        check(code == 0, 'exit code %d' % code)
        table = text.split('== What was found')[1].split('== Files')[0]
        rows = {line.split('  ')[0]: line.split() for line in table.splitlines() if line}
        # the cloth has 1,023 dots; a front sees nearly all of them
        for name in ('cam0', 'cam3', 'cam4'):
            check(900 < float(rows[name][2]) < 1100, '%s: %s dots' % (name, rows[name][2]))
            check(float(rows[name][3].rstrip('%')) > 90, '%s: %s labelled' % (name, rows[name][3]))
        take = folder + '/garment/cloth.take'
        with open(take + '/states.npy', 'rb') as file:
            states = file.read()[128:]
        for word, state in (('three views', 1), ('two views', 2), ('filled', 3), ('unseen', 0)):
            share = '%.1f%%' % (100 * states.count(state) / len(states))
            check(share in rows[word], '%s: %s in %s' % (word, share, rows[word]))
        # info sums them up, and does so when there is nothing else in the take
        tool = os.path.join(os.environ['CLOTH_BUILD'], 'tools/gst-cloth-take-1.0')
        told = []
        other = folder + '/other'
        shutil.copytree(take, other)
        for name in None, 'positions.npy', 'states.npy', 'covariance.npy':
            if name and os.path.exists(other + '/' + name):
                os.remove(other + '/' + name)
            if name not in ('positions.npy', 'states.npy'):
                done = subprocess.run([tool, 'info', other], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                      check=False)
                check(done.returncode == 0, done.stdout.decode())
                told.append(done.stdout.decode())
        for n in range(8):
            rows = [re.search(r'cam%d: (\d+) pictures, (\d+) points, ([\d.]+) %% of the vertices in a picture$' % n,
                              text, re.M).groups() for text in told]
            check(rows[0] == rows[1] and int(rows[0][0]) == len(states) // 1023, 'cam%d: %s' % (n, rows))
            check(abs(float(rows[0][2]) - 100 * int(rows[0][1]) / len(states)) < 0.06, 'and the share of vertices')
        check('no places, only what cameras saw' in told[1] and 'only what' not in told[0], told[1])
        front = re.search(r'cam0: \d+ pictures, (\d+) points', told[0]).group(1)
        check(800 < int(front) / (len(states) // 1023) < 1100, 'a front sees nearly all')
        with open(take + '/observations/cam3.obs', 'r+b') as file:
            file.truncate(1000)
        done = subprocess.run([tool, 'info', take], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        check(done.returncode == 0 and 'cameras     not read: ' in done.stdout.decode() and
              'cam3.obs' in done.stdout.decode(), 'info of a file that was cut off: ' + done.stdout.decode())
        script = os.path.join(ROOT, 'pipelines/dots-summary.py')
        for words in ('cam3.obs: byte 0 begins no observation', 'no observations/CAMERA.obs'):
            done = subprocess.run([script, take], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
            check(done.returncode == 1 and words in done.stdout.decode(), words)
            shutil.rmtree(take + '/observations', ignore_errors=True)


def main():
    Gst.init(None)
    try:
        globals()['case_' + sys.argv[1].replace('-', '_')](sys.argv[2])
    except Failure as failure:
        print('failed: %s' % failure)
        return 1
    return 0


sys.exit(main())
