#!/usr/bin/python3
"""Sub-pixel corners, quads, dots, meshes and observations, read and written from Python.

Needs GI_TYPELIB_PATH and LD_LIBRARY_PATH to find libgstcloth-1.0 and its typelib.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import math
import random
import struct
import unittest

import gi
gi.require_version('Gst', '1.0')
gi.require_version('GstCloth', '1.0')
from gi.repository import GLib, Gst, GstCloth  # noqa: E402
import numpy  # noqa: E402

Gst.init(None)
WIDTH, HEIGHT, FRAMES = 322, 240, 5
TREE = ('appsrc name=source format=time caps=video/x-raw,format=GRAY8,width=%d,height=%d,'
        'framerate=25/1 ! tee name=t ! queue ! jpegenc ! jpegdec ! appsink name=coded '
        'sync=false t. ! queue ! appsink name=raw sync=false' % (WIDTH, HEIGHT))


def make_saddles(rand):
    saddles = []
    for _ in range(rand.randrange(1, 200)):
        saddle = GstCloth.Saddle()
        saddle.x, saddle.y = rand.uniform(0, 321), rand.uniform(0, 239)
        saddle.response, saddle.axis = rand.uniform(1, 900), rand.uniform(0, 3.14)
        saddle.cov_xx, saddle.cov_xy, saddle.cov_yy = 1e-4, -1e-5, rand.uniform(0, 1e-3)
        saddles.append(saddle)
    return saddles


def floats(saddle):
    return [saddle.x, saddle.y, saddle.response, saddle.axis, saddle.cov_xx,
            saddle.cov_xy, saddle.cov_yy]


class Saddles(unittest.TestCase):
    def test_through_tee_queue_and_jpeg(self):
        rand = random.Random(1)
        pipeline = Gst.parse_launch(TREE)
        source = pipeline.get_by_name('source')
        attached = []
        pipeline.set_state(Gst.State.PLAYING)
        for number in range(FRAMES):
            stride = (WIDTH + 3) // 4 * 4
            picture = Gst.Buffer.new_wrapped(rand.randbytes(stride * HEIGHT))
            picture.pts = number * Gst.SECOND // 25
            saddles = make_saddles(rand)
            candidate = GstCloth.Candidate()
            candidate.x, candidate.y, candidate.response = number, 3, 7
            GstCloth.buffer_add_cloth_saddles_meta(picture, GstCloth.Saddles.new(
                'cam0', 100 + number, saddles, [candidate]))
            attached.append([floats(saddle) for saddle in saddles])
            self.assertEqual(source.emit('push-buffer', picture), Gst.FlowReturn.OK)
        source.emit('end-of-stream')
        for name in ('raw', 'coded'):
            sink = pipeline.get_by_name(name)
            for number, values in enumerate(attached):
                sample = sink.emit('try-pull-sample', 60 * Gst.SECOND)
                self.assertIsNotNone(sample, name)
                payload = GstCloth.buffer_get_cloth_saddles(sample.get_buffer())
                self.assertIsNotNone(payload, name)
                self.assertEqual(payload.get_camera(), 'cam0')
                self.assertEqual(payload.get_sequence(), 100 + number)
                self.assertEqual([floats(saddle) for saddle in payload.get_refined()], values)
                self.assertEqual(payload.get_candidates()[0].x, number)
                found, saddle = payload.get_saddle(len(values) - 1)
                self.assertTrue(found)
                self.assertEqual(floats(saddle), values[-1])
                array = numpy.frombuffer(payload.get_points().get_data(), numpy.float32)
                self.assertTrue((array.reshape(-1, 7) == numpy.float32(values)).all())
            self.assertIsNone(sink.emit('try-pull-sample', 60 * Gst.SECOND))
        pipeline.set_state(Gst.State.NULL)

    def test_payload_outlives_its_buffer(self):
        picture = Gst.Buffer.new()
        GstCloth.buffer_add_cloth_saddles_meta(
            picture, GstCloth.Saddles.new('a', 1, make_saddles(random.Random(2)), []))
        payload = GstCloth.buffer_get_cloth_saddles(picture)
        points = payload.get_points()
        n = payload.get_n_refined()
        del picture, payload
        self.assertEqual(points.get_size(), 28 * n)

    def test_absent(self):
        self.assertIsNone(GstCloth.buffer_get_cloth_saddles(Gst.Buffer.new()))
        self.assertIsNone(GstCloth.buffer_get_cloth_quads(Gst.Buffer.new()))
        payload = GstCloth.Saddles.new(None, 0, [], [])
        self.assertEqual(payload.get_camera(), '')
        self.assertEqual(payload.get_refined(), [])
        self.assertFalse(payload.get_saddle(0)[0])


class Quads(unittest.TestCase):
    def test_corners(self):
        quad = GstCloth.Quad()
        quad.column, quad.row, quad.black = 3, 2, True
        quad.state, quad.confidence = GstCloth.QuadState.PREDICTED, 0.5
        for corner in range(4):
            self.assertTrue(quad.set_corner(corner, corner + 0.5, 2 * corner, 1, 0.25, 2))
        self.assertFalse(quad.set_corner(4, 0, 0, 0, 0, 0))
        picture = Gst.Buffer.new()
        GstCloth.buffer_add_cloth_quads_meta(picture, GstCloth.Quads.new(
            'cam1', 9, 8, 6, [quad]))
        quads = GstCloth.buffer_get_cloth_quads(picture)
        self.assertEqual((quads.get_columns(), quads.get_rows()), (8, 6))
        found, got = quads.get_quad(0)
        self.assertTrue(found)
        self.assertEqual(got.state, GstCloth.QuadState.PREDICTED)
        self.assertEqual(got.get_corner(2), (True, 2.5, 4, 1, 0.25, 2))
        points = numpy.frombuffer(quads.get_points().get_data(), numpy.float32)
        self.assertEqual(points.reshape(-1, 4, 2).tolist(),
                         [[[0.5, 0], [1.5, 2], [2.5, 4], [3.5, 6]]])


class Dots(unittest.TestCase):
    def test_labels_and_colours(self):
        dot = GstCloth.Dot()
        dot.column, dot.row, dot.mirrored, dot.confidence = 3, 2, True, 0.5
        dot.x, dot.y, dot.cov_xx, dot.cov_xy, dot.cov_yy = 1.5, 2.5, 1, 0.25, 2
        for colour in range(GstCloth.DOT_MAX_COLOURS):
            self.assertTrue(dot.set_log_likelihood(colour, -colour))
        self.assertFalse(dot.set_log_likelihood(GstCloth.DOT_MAX_COLOURS, 0))
        bare = GstCloth.Dot()
        bare.column = bare.row = -1
        picture = Gst.Buffer.new()
        self.assertIsNone(GstCloth.buffer_get_cloth_dots(picture))
        GstCloth.buffer_add_cloth_dots_meta(picture, GstCloth.Dots.new(
            'cam1', 9, 31, 33, 5, [dot, bare]))
        dots = GstCloth.buffer_get_cloth_dots(picture)
        self.assertEqual((dots.get_columns(), dots.get_rows(), dots.get_n_colours()),
                         (31, 33, 5))
        found, got = dots.get_dot(0)
        self.assertTrue(found and got.mirrored and not got.touches)
        self.assertEqual(got.get_log_likelihood(4), (True, -4))
        points = numpy.frombuffer(dots.get_points().get_data(), numpy.float32)
        self.assertEqual(points.reshape(-1, 8).tolist(),
                         [[3, 2, 1.5, 2.5, 1, 0.25, 2, 0.5], [-1, -1, 0, 0, 0, 0, 0, 0]])
        self.assertEqual(len(dots.get_dots()), 2)


class Silhouettes(unittest.TestCase):
    def test_runs_and_mask(self):
        run = GstCloth.Run()
        run.row, run.begin, run.end = 1, 2, 5
        picture = Gst.Buffer.new()
        self.assertIsNone(GstCloth.buffer_get_cloth_silhouette(picture))
        GstCloth.buffer_add_cloth_silhouette_meta(picture, GstCloth.Silhouette.new(
            'cam1', 9, 7, 3, [run]))
        silhouette = GstCloth.buffer_get_cloth_silhouette(picture)
        self.assertEqual((silhouette.get_width(), silhouette.get_height(),
                          silhouette.get_area()), (7, 3, 3))
        self.assertEqual([(run.row, run.begin, run.end) for run in silhouette.get_runs()],
                         [(1, 2, 5)])
        mask = numpy.frombuffer(silhouette.get_mask().get_data(), numpy.uint8).reshape(3, 7)
        self.assertEqual(numpy.argwhere(mask == 255).tolist(), [[1, 2], [1, 3], [1, 4]])


class Prints(unittest.TestCase):
    def test_matches(self):
        match, point = GstCloth.Match(), GstCloth.GridPoint()
        match.x, match.y, match.u, match.v, match.scale = 1.5, 2.5, 0.25, 0.5, 2
        match.distance, match.group, match.verified = 100, 7, True
        point.column, point.row, point.x, point.y, point.cov_xx = 34, 32, 3, 4, 0.25
        picture = Gst.Buffer.new()
        self.assertIsNone(GstCloth.buffer_get_cloth_matches(picture))
        GstCloth.buffer_add_cloth_matches_meta(picture, GstCloth.Matches.new(
            'cam1', 9, 35, 33, 4, True, [match], [point]))
        matches = GstCloth.buffer_get_cloth_matches(picture)
        self.assertEqual((matches.get_columns(), matches.get_rows(), matches.get_n_features(),
                          matches.get_on_surface()), (35, 33, 4, True))
        self.assertEqual([m.group for m in matches.get_matches()], [7])
        self.assertEqual([(p.column, p.row, p.y) for p in matches.get_points()], [(34, 32, 4)])
        self.assertFalse(matches.get_point(1)[0])
        table = numpy.frombuffer(matches.get_table().get_data(), numpy.float32)
        self.assertEqual(table.tolist(), [1.5, 2.5, 0.25, 0.5, 2, 100, 1])

    def test_disparity(self):
        stereo = GstCloth.Stereo.new(2, 1, [0.5, -0.25, 0, 0], [0, 0, 1], 100,
                                     [1, 0, 0, 0, 1, 0, 0, 0, 1], [0, 0, 0.5], 3)
        self.assertEqual(stereo.get_rays(), [0.5, -0.25, 0, 0])
        self.assertEqual(list(stereo.get_translation()), [0, 0, 0.5])
        picture = Gst.Buffer.new()
        GstCloth.buffer_add_cloth_disparity_meta(picture, GstCloth.Disparity.new(
            'cam1', 9, stereo, 0.5, [50, math.nan],
            [GstCloth.DisparityState.MEASURED, GstCloth.DisparityState.HOLE]))
        disparity = GstCloth.buffer_get_cloth_disparity(picture)
        self.assertEqual(list(disparity.get_states()), [2, 1])
        points = numpy.frombuffer(disparity.get_points().get_data(), numpy.float32)
        self.assertEqual(points[:3].tolist(), [1, -0.5, 2])
        self.assertTrue(numpy.isnan(points[3:]).all())

    def test_uv(self):
        mesh = Gst.Buffer.new()
        for camera, u in (('left', 0.25), ('right', 0.5)):
            GstCloth.buffer_add_cloth_uv_meta(
                mesh, GstCloth.UV.new(camera, 3, 1, 2, [u, 0.125, math.nan, 0]))
        uv = GstCloth.buffer_get_cloth_uv(mesh.copy(), 'right')
        self.assertEqual(uv.get_uv()[:2], [0.5, 0.125])
        places = numpy.frombuffer(uv.get_map().get_data(), numpy.float32).reshape(2, 1, 2)
        self.assertTrue(numpy.isnan(places[1, 0]).all())
        self.assertEqual(GstCloth.buffer_get_nth_cloth_uv(mesh, 0).get_camera(), 'left')
        self.assertIsNone(GstCloth.buffer_get_nth_cloth_uv(mesh, 2))
        self.assertIsNone(GstCloth.buffer_get_cloth_uv(mesh, 'middle'))

    def test_view(self):
        mesh, picture, seen = Gst.Buffer.new(), Gst.Buffer.new(), Gst.Buffer.new()
        GstCloth.buffer_add_cloth_saddles_meta(picture, GstCloth.Saddles.new('', 3, [], []))
        GstCloth.buffer_add_cloth_view_meta(
            mesh, GstCloth.View.new('left', 3, GstCloth.observations_pack(picture)))
        view = GstCloth.buffer_get_cloth_view(mesh.copy(), 'left')
        self.assertEqual((view.get_camera(), view.get_sequence()), ('left', 3))
        self.assertTrue(GstCloth.observations_unpack(view.get_observation(), seen))
        self.assertEqual(GstCloth.buffer_get_cloth_saddles(seen).get_sequence(), 3)
        self.assertIsNone(GstCloth.buffer_get_nth_cloth_view(mesh, 1))


class Streams(unittest.TestCase):
    """The layouts of docs/streams.md, written here by struct."""

    def test_mesh(self):
        data = struct.pack('<4sHHQIIQ', b'GCMB', 1, 32, 77, 2, 1, 0)
        nan = math.nan
        data += struct.pack('<6f', 1, 2, 3, nan, nan, nan)
        data += struct.pack('<12f', 1, 2, 3, 4, 5, 6, *[nan] * 6) + bytes([1, 0])
        mesh = GstCloth.Mesh.from_buffer(Gst.Buffer.new_wrapped(data))
        self.assertEqual(mesh.get_sequence(), 77)
        self.assertEqual(mesh.get_positions()[:3], [1, 2, 3])
        self.assertTrue(all(map(math.isnan, mesh.get_positions()[3:])))
        self.assertEqual(mesh.get_covariances()[:6], [1, 2, 3, 4, 5, 6])
        self.assertEqual(list(mesh.get_states()), [GstCloth.VertexState.MEASURED,
                                                   GstCloth.VertexState.UNSEEN])
        points = numpy.frombuffer(mesh.get_points().get_data(), numpy.float32).reshape(2, 3)
        self.assertEqual(points[0].tolist(), [1, 2, 3])
        self.assertTrue(numpy.isnan(points[1]).all())
        # Mapped, the array is in the mesh's own memory, which the bytes keep.
        wrapped = [Gst.Buffer.new_wrapped_bytes(mesh.get_points()) for _ in range(2)]
        with wrapped[0].map(Gst.MapFlags.READ) as one, wrapped[1].map(Gst.MapFlags.READ) as two:
            views = [numpy.frombuffer(memory.data, numpy.float32) for memory in (one, two)]
            self.assertEqual(views[0].ctypes.data, views[1].ctypes.data)
            self.assertFalse(views[0].flags.writeable)
            self.assertEqual(views[0][:3].tolist(), [1, 2, 3])
            del views
        again = GstCloth.Mesh.new(77, mesh.get_positions(), mesh.get_states(),
                                  mesh.get_covariances()).to_buffer()
        # NaN may differ in its bits.
        self.assertEqual(numpy.frombuffer(again.extract_dup(0, 32), numpy.uint8).tolist(),
                         list(data[:32]))
        self.assertEqual(again.extract_dup(0, again.get_size())[-2:], data[-2:])

    def test_topology(self):
        topology = GstCloth.Topology.new_grid(3, 2, 1, 0.5)
        caps = Gst.Caps.from_string(topology.to_caps(25, 1).to_string())
        read = GstCloth.Topology.from_caps(caps)
        self.assertEqual(read.get_uv(), [0, 0, 0.5, 0, 1, 0, 0, 0.5, 0.5, 0.5, 1, 0.5])
        self.assertEqual(read.get_faces(), [0, 3, 4, 1, 1, 4, 5, 2])
        triangle = GstCloth.Topology.new(0, 0, [0, 0, 1, 0, 0, 1],
                                         [0, 1, 2, GstCloth.NO_VERTEX])
        self.assertEqual(triangle.get_n_faces(), 1)
        data = triangle.to_buffer()
        self.assertEqual(data.extract_dup(0, data.get_size()), struct.pack(
            '<4sHHIIIIQ6f4I', b'GCTP', 1, 32, 3, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1,
            0, 1, 2, 0xffffffff))

    def test_observations(self):
        name = 'linke Kamera №1'.encode()
        padding = bytes(-len(name) % 4)
        saddles = struct.pack('<QIIHH', 5, 1, 0, len(name), 0) + name + padding
        saddles += struct.pack('<7f', 1.5, 2.5, 3, 0.25, 1, 0, 1)
        data = struct.pack('<4sHHIIQQ', b'GCOB', 1, 32, 32 + 8 + len(saddles), 1, 0, 0)
        data += struct.pack('<4sI', b'SADL', len(saddles)) + saddles
        target = Gst.Buffer.new()
        self.assertTrue(GstCloth.observations_unpack(Gst.Buffer.new_wrapped(data), target))
        payload = GstCloth.buffer_get_cloth_saddles(target)
        self.assertEqual(payload.get_camera(), name.decode())
        self.assertEqual(floats(payload.get_refined()[0]), [1.5, 2.5, 3, 0.25, 1, 0, 1])
        target.pts = target.duration = 0
        packed = GstCloth.observations_pack(target)
        self.assertEqual(packed.extract_dup(0, packed.get_size()), data)

    def test_gap(self):
        buffer = Gst.Buffer.new()
        self.assertIsNone(GstCloth.buffer_get_cloth_gap(buffer))
        GstCloth.buffer_add_cloth_gap_meta(
            buffer, GstCloth.Gap.new(9, [0.5, -0.25, 1, math.nan, 0, 0], [0.125, math.nan]))
        gap = GstCloth.buffer_get_cloth_gap(buffer.copy())
        self.assertEqual((gap.get_sequence(), gap.get_n_vertices()), (9, 2))
        self.assertEqual(gap.get_residuals()[:3], [0.5, -0.25, 1])
        self.assertTrue(all(map(math.isnan, gap.get_residuals()[3:])))
        self.assertEqual(gap.get_sigmas()[0], 0.125)
        self.assertTrue(math.isnan(GstCloth.Gap.new(0, [1, 2, 3], None).get_sigmas()[0]))
        with self.assertRaises(GLib.Error):
            GstCloth.Gap.new(0, [1, 2], None)
        with self.assertRaises(GLib.Error):
            GstCloth.Gap.new(0, [1, 2, 3], [1, 2])

    def test_errors(self):
        bad = Gst.Buffer.new_wrapped(b'GCMB\2\0\x20\0')
        with self.assertRaises(GLib.Error) as caught:
            GstCloth.Mesh.from_buffer(bad)
        self.assertTrue(caught.exception.matches(GstCloth.error_quark(),
                                                 GstCloth.Error.VERSION))
        with self.assertRaises(GLib.Error):
            GstCloth.observations_unpack(bad, Gst.Buffer.new())
        with self.assertRaises(GLib.Error):
            GstCloth.Topology.new(0, 0, [0, 0, 1], [])
        with self.assertRaises(GLib.Error):
            GstCloth.Topology.from_caps(Gst.Caps.from_string('video/x-raw'))


if __name__ == '__main__':
    unittest.main(verbosity=2)
