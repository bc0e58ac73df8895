#!/usr/bin/python3
"""What was found, in Python: squares of a film as CSV, meshes as NumPy arrays.

  metas.py squares FILM PATTERN     a line for each corner of each square, on the standard output
  metas.py meshes TAKE              a line for each frame of a mesh stream

Packages: python3-gi, python3-gst-1.0 (memory without a copy), python3-numpy.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import signal
import sys

import gi

gi.require_version('Gst', '1.0')
gi.require_version('GstCloth', '1.0')
from gi.repository import Gst, GstCloth
import numpy


def samples(description, **properties):
    """Each sample that reaches the pipeline's appsink. An error ends the program, warnings go to the
    error stream: of late pictures, another print than was said, cameras that contradict each other."""
    pipeline = Gst.parse_launch(description + ' ! appsink name=sink sync=false')
    for name, value in properties.items():
        element, _, key = name.partition('_')
        pipeline.get_by_name(element).set_property(key, value)
    sink, bus = pipeline.get_by_name('sink'), pipeline.get_bus()
    pipeline.set_state(Gst.State.PLAYING)
    try:
        while not sink.get_property('eos'):
            sample = sink.emit('try-pull-sample', Gst.SECOND // 10)
            if sample is not None:
                yield sample
            # An element that can't go on says so on the bus, and sends nothing more.
            while message := bus.pop_filtered(Gst.MessageType.ERROR | Gst.MessageType.WARNING):
                if message.type == Gst.MessageType.ERROR:
                    sys.exit(message.parse_error()[0].message)
                print('warning:', message.parse_warning()[0].message, file=sys.stderr)
    finally:
        pipeline.set_state(Gst.State.NULL)


def squares(film, pattern):
    print('time_s,column,row,corner,x_px,y_px,confidence')
    for sample in samples('filesrc name=film ! decodebin ! videoconvert ! saddledetect'
                          ' ! quadtrack name=track', film_location=film, track_pattern=pattern):
        buffer = sample.get_buffer()
        quads = GstCloth.buffer_get_cloth_quads(buffer)
        if quads is None:
            continue
        # All corners at once; the rest square by square.
        points = numpy.frombuffer(quads.get_points().get_data(), numpy.float32).reshape(-1, 4, 2)
        for quad, corners in zip(quads.get_quads(), points):
            if quad.state != GstCloth.QuadState.TRACKED:
                continue
            for corner, (x, y) in enumerate(corners):
                print('%.6f,%d,%d,%d,%.3f,%.3f,%.3f' % (
                    buffer.pts / Gst.SECOND, quad.column, quad.row, corner, x, y, quad.confidence))


def meshes(take):
    if not hasattr(Gst.MapInfo, '__enter__'):
        sys.exit('Mapped memory needs the package python3-gst-1.0')
    print('frame,seen,x_m,y_m,z_m')
    for sample in samples('meshsrc name=take', take_location=take):
        mesh = GstCloth.Mesh.from_buffer(sample.get_buffer())
        # A mapped buffer is a memoryview: the array lies in the memory that GStreamer has.
        with Gst.Buffer.new_wrapped_bytes(mesh.get_points()).map(Gst.MapFlags.READ) as memory:
            points = numpy.frombuffer(memory.data, numpy.float32).reshape(-1, 3)
            seen = numpy.isfinite(points[:, 0])
            print('%d,%d,%.6f,%.6f,%.6f' % (mesh.get_sequence(), seen.sum(),
                                            *numpy.nanmean(points, axis=0, dtype=float)))
            # Views end before their memory does.
            del points, seen


Gst.init(None)
# Who reads only the first lines, as head does, ends this program without a word.
signal.signal(signal.SIGPIPE, signal.SIG_DFL)
if len(sys.argv) == 4 and sys.argv[1] == 'squares':
    squares(*sys.argv[2:])
elif len(sys.argv) == 3 and sys.argv[1] == 'meshes':
    meshes(sys.argv[2])
else:
    sys.exit(__doc__)
