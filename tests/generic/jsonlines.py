#!/usr/bin/python3
"""Reads the lines of clothjson by Python's json, and holds them against their schema.

  jsonlines.py ROOT

A second branch of the pipelines gives the payloads themselves, and NumPy the take.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import sys

import gi

gi.require_version('Gst', '1.0')
gi.require_version('GstCloth', '1.0')
from gi.repository import Gst, GstCloth
import jsonschema
import numpy

Gst.init(None)
root = sys.argv[1]
data = os.path.join(root, 'tests/data')
with open(os.path.join(root, 'docs/jsonlines.schema.json'), encoding='utf-8') as file:
    schema = json.load(file)
jsonschema.Draft202012Validator.check_schema(schema)
schema = jsonschema.Draft202012Validator(schema)
faults = []


def expect(true, what):
    if not true:
        faults.append(what)


def near(a, b):
    return numpy.allclose(numpy.array(a, float), numpy.array(b, float), rtol=1e-6, atol=1e-12,
                          equal_nan=True)


def run(description):
    """The buffers of the appsinks "lines" and, when there is one, "metas"."""
    pipeline = Gst.parse_launch(description)
    got = {name: [] for name in ('lines', 'metas')}
    pipeline.set_state(Gst.State.PLAYING)
    for name, buffers in got.items():
        sink = pipeline.get_by_name(name)
        while sink:
            sample = sink.emit('pull-sample')
            if sample is None:
                break
            buffers.append(sample.get_buffer())
    pipeline.set_state(Gst.State.NULL)
    texts = [bytes(b.extract_dup(0, b.get_size())).decode('ascii') for b in got['lines']]
    for text in texts:
        expect(text.endswith('}\n') and text.count('\n') == 1, 'a line: ' + text[-20:])
    lines = [json.loads(text) for text in texts]
    for line in lines:
        expect(schema.is_valid(line), 'the schema: %s' % str(line)[:100])
    return lines, got['metas']


BRANCHES = (' ! tee name=t t. ! queue max-size-buffers=0 max-size-bytes=0 max-size-time=0'
            ' ! clothjson ! appsink name=lines sync=false'
            ' t. ! queue max-size-buffers=0 max-size-bytes=0 max-size-time=0'
            ' ! appsink name=metas sync=false')
lines, metas = run(
    'filesrc location=%s/checker_pair/cam0.mp4 ! decodebin ! videoconvert ! saddledetect'
    ' ! quadtrack pattern=%s/checker_pair/pattern.json camera=cam0' % (data, data) + BRANCHES)
expect(len(lines) == len(metas) == 63, '%d pictures' % len(lines))
for line, buffer in zip(lines, metas):
    quads = GstCloth.buffer_get_cloth_quads(buffer)
    expect(line['camera'] == 'cam0' and line['frame'] == quads.get_sequence()
           and len(line['squares']) == quads.get_n_quads(), 'a picture of squares')
    expect(set(line) == {'frame', 'time_s', 'camera', 'squares'}, 'its keys')
    for square, quad in zip(line['squares'], quads.get_quads()):
        corners = [quad.get_corner(k)[1:] for k in range(4)]
        expect((square['column'], square['row'], square['black'])
               == (quad.column, quad.row, bool(quad.black))
               and square['state'] == quad.state.value_nick
               and near(square['confidence'], quad.confidence)
               and near(square['corners_px'], [c[:2] for c in corners])
               and near(square['covariances_px2'], [c[2:] for c in corners]), 'a square')
expect(near([line['time_s'] for line in lines], numpy.arange(63) / 25), 'running times')

lines, metas = run(
    'filesrc location=%s/dots_ring8/cam0.mp4 ! decodebin ! videoconvert'
    ' ! dotlabel pattern=%s/dots_ring8/pattern.json camera=cam0' % (data, data) + BRANCHES)
expect(len(lines) == 1 and len(lines[0]['dots']) > 100, 'dots')
dots = GstCloth.buffer_get_cloth_dots(metas[0])
for item, k in zip(lines[0]['dots'], range(dots.get_n_dots())):
    dot = dots.get_dot(k)[1]
    expect((-1 if item['column'] is None else item['column'],
            -1 if item['row'] is None else item['row']) == (dot.column, dot.row)
           and near(item['centre_px'], [dot.x, dot.y])
           and near(item['covariance_px2'], [dot.cov_xx, dot.cov_xy, dot.cov_yy])
           and near(item['log_likelihoods'], [dot.get_log_likelihood(c)[1]
                                              for c in range(dots.get_n_colours())]), 'a dot')

lines, metas = run(
    'filesrc location=%s/lineart_stereo3/cam0.mp4 ! decodebin ! videoconvert ! identity eos-after=2'
    ' ! siftmatch pattern=%s/lineart_stereo3/pattern.json camera=cam0' % (data, data) + BRANCHES)
matches = GstCloth.buffer_get_cloth_matches(metas[0])
expect(len(lines[0]['matches']) == matches.get_n_matches() > 20
       and len(lines[0]['vertices']) == matches.get_n_points(), 'matches')
table = numpy.frombuffer(matches.get_table().get_data(), numpy.float32).reshape(-1, 7)
expect(near([m['place_px'] + m['uv_m'] + [m['scale_px'], m['distance'], m['verified']]
             for m in lines[0]['matches']], table), 'their numbers')

for name in 'take_drop', 'take_drag':
    take = os.path.join(data, name)
    positions = numpy.load(os.path.join(take, 'positions.npy'))
    lines, _ = run('meshsrc location=%s ! clothjson ! appsink name=lines sync=false' % take)
    expect(len(lines) == len(positions), name)
    for frame, line in enumerate(lines):
        got = [p or [None] * 3 for p in line['positions_m']]
        expect(near(got, positions[frame]) and line['frame'] == frame
               and line['columns'] * line['rows'] == len(got)
               and [s != 'unseen' for s in line['states']]
               == numpy.isfinite(positions[frame, :, 0]).tolist(), '%s, frame %d' % (name, frame))

# What the schema is there to refuse.
good = {'frame': 0, 'time_s': None, 'camera': None}
expect(schema.is_valid(good), 'an empty picture')
for bad in ({'frame': 0}, dict(good, squares=1), dict(good, more=1), dict(good, frame='0'),
            dict(good, squares=[{'column': -1}]), {'frame': 0, 'time_s': 0, 'positions_m': []},
            {'frame': 0, 'time_s': 0, 'positions_m': [[0, 0]], 'states': ['measured']},
            {'frame': 0, 'time_s': 0, 'positions_m': [None], 'states': ['seen']}):
    expect(not schema.is_valid(bad), 'it is accepted: %s' % bad)
for fault in faults[:20]:
    print('FAULT: ' + fault)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
