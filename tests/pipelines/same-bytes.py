#!/usr/bin/python3
"""The same bytes with every instruction set and any number of threads.

  same-bytes.py TOOL DATA      TOOL: gst-cloth-gap-1.0; DATA: tests/data

Runs the main jobs in processes of their own, in which CLOTH_SIMD lowers the instruction
set, and compares every file that they write. The first run is the portable one, with one
thread; the others, which alternate between threads, must equal it.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import hashlib
import os
import re
import subprocess
import sys
import tempfile

LEVELS = ['scalar', 'avx2', 'avx512', None]     # None: the best that the processor has
# the levels of a stereo head's job, and the files that it writes
HEAD_FILES = ('disparity_', 'print.take')
HEAD_LEVELS = ['scalar', None]
# of the runs, one after the other
THREADS = [1, 3, 2]


def jobs(tool, data, threads):
    """Command lines that write into the folder they run in."""
    pair, dots, drag, lines = (os.path.join(data, name) for name in
                               ('checker_pair', 'dots_ring8', 'take_drag', 'lineart_stereo3'))
    models = os.path.join(data, '../../pipelines')
    film = ('filesrc location=%s/%s.mp4 ! qtdemux ! h264parse ! avdec_h264 max-threads=1 '
            '! identity eos-after=%d ! saddledetect ! quadtrack pattern=%s/pattern.json camera=%s ')
    return [
        'gst-launch-1.0 -q ' + film % (pair, 'cam0', 5, pair, 'cam0') + '! tee name=t '
        't. ! queue ! clothmetapay ! filesink location=squares.obs '
        't. ! queue ! clothoverlay ! filesink location=overlay.yuv',
        'gst-launch-1.0 -q triangulate name=join threads=%d rig=%s/rig.json pattern=%s/pattern.json '
        '! meshfill ! meshsink location=mesh.take ' % (threads, pair, pair)
        + ' '.join(film % (pair, camera, 4, pair, camera) + '! queue ! join.'
                   for camera in ('cam0', 'cam1')),
        'gst-launch-1.0 -q filesrc location=%s/cam0.mp4 ! decodebin ! videoconvert '
        '! video/x-raw,format=I420 ! dotlabel pattern=%s/pattern.json camera=cam0 '
        '! clothmetapay ! filesink location=dots.obs' % (dots, dots),
        'gst-launch-1.0 -q meshsrc location=mesh.take ! identity eos-after=3 '
        '! clothcamera threads=%d rig=%s/rig.json camera=cam1 pattern=%s/pattern.json '
        'effects=noise,sigma=3;motion_blur,exposure=0.01 seed=3 ! filesink location=film.yuv'
        % (threads, pair, pair),
        'gst-launch-1.0 -q filesrc location=%s/cam0.mp4 ! qtdemux ! h264parse '
        '! avdec_h264 max-threads=1 ! identity eos-after=4 ! silhouette luma-max=150 threads=%d '
        '! clothmetapay ! filesink location=silhouette.obs' % (pair, threads),
        'gst-launch-1.0 -q filesrc location=%s/cam0.mp4 ! qtdemux ! h264parse '
        '! avdec_h264 max-threads=1 ! identity eos-after=1 ! siftmatch pattern=%s/pattern.json '
        'oblique=0 threads=%d ! clothmetapay ! filesink location=matches.obs'
        % (lines, lines, threads),
        '%s simulate %s/model-knit.json --scene %s --threads %d --output simulated'
        % (tool, models, drag, threads),
        '%s diagnose %s --model %s/model-knit.json --effects wind,air_drag,stretch --threads %d '
        '--output gap' % (tool, drag, models, threads),
    ]


def head_job(data, threads):
    """A stereo head's way to a mesh: long, so not for every instruction set."""
    lines = os.path.join(data, 'lineart_stereo3')
    film = 'filesrc location=%s/%s.mp4 ! qtdemux ! h264parse ! avdec_h264 max-threads=1 '
    return ('gst-launch-1.0 -q clothdisparity name=head rig=%s/rig.json threads=%d near=1 far=3 '
            'location=disparity_%%d.pfm ! identity eos-after=2 '
            '! siftmatch pattern=%s/pattern.json oblique=0 threads=%d '
            '! uvmap pattern=%s/pattern.json threads=%d ! meshsink location=print.take '
            % (lines, threads, lines, threads, lines, threads)
            + film % (lines, 'cam0') + '! silhouette background=%s/background0.png ! head.sink_0 '
            % lines
            + ' '.join(film % (lines, 'cam%d' % k) + '! head.sink_%d' % k for k in (1, 2)))


def digests(folder):
    """Of every file; how long a diagnosis took is no part of it."""
    found = {}
    for top, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(top, name)
            with open(path, 'rb') as file:
                content = re.sub(rb'"seconds": [0-9.e+-]+', b'', file.read())
            assert content, '%s is empty' % path
            found[os.path.relpath(path, folder)] = hashlib.sha256(content).hexdigest()
    return found


def run(tool, data, level, threads):
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ)
        environment.pop('CLOTH_SIMD', None)
        if level:
            environment['CLOTH_SIMD'] = level
        long = [head_job(data, threads)] if level in HEAD_LEVELS else []
        for job in jobs(tool, data, threads) + long:
            done = subprocess.run(job.split(), cwd=folder, env=environment, timeout=300,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
            assert done.returncode == 0, '%s: %s' % (job, done.stdout.decode())
        return digests(folder)


def effective(level):
    """What this processor has of a level."""
    flags = set()
    with open('/proc/cpuinfo', encoding='utf-8') as file:
        for line in file:
            if line.startswith('flags'):
                flags.update(line.split())
    best = 2 if flags >= {'bmi2', 'avx512f', 'avx512bw', 'avx512dq', 'avx512vl'} else \
        1 if flags >= {'avx2', 'fma'} else 0
    return LEVELS[min(best, LEVELS.index(level) if level else 2)]


def check_names(tool):
    """A level that isn't one is said, and nothing else changes."""
    done = subprocess.run([tool, 'effects'], env={**os.environ, 'CLOTH_SIMD': 'sse9'}, check=False,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert done.returncode == 0, done
    script = 'videotestsrc num-buffers=1 ! video/x-raw,format=GRAY8 ! saddledetect ! fakesink'
    done = subprocess.run(['gst-launch-1.0', '-q'] + script.split(), check=False,
                          env={**os.environ, 'CLOTH_SIMD': 'sse9'}, stderr=subprocess.PIPE)
    assert b'CLOTH_SIMD=sse9 is ignored' in done.stderr, done.stderr


def main(tool, data):
    check_names(tool)
    first = None
    best = effective(None)
    # a level that this processor has not is its best one again
    levels = [level for level in LEVELS if not level or effective(level) == level != best]
    if len(levels) < 2:
        levels.append(None)
    for level, threads in zip(levels, THREADS):
        found = run(tool, data, level, threads)
        if first is None:
            first = found
            assert len(found) > 12, sorted(found)
            assert sum(name.endswith('.pfm') for name in found) >= 1, sorted(found)
            assert any(name.startswith('print.take') for name in found), sorted(found)
        expected = {name: digest for name, digest in first.items()
                    if level in HEAD_LEVELS or not name.startswith(HEAD_FILES)}
        differ = sorted(name for name in expected.keys() | found.keys()
                        if expected.get(name) != found.get(name))
        print('%s (here %s), %d threads: %d files, %d differ %s'
              % (level or 'best', effective(level), threads, len(found), len(differ), differ))
        assert not differ


if __name__ == '__main__':
    main(*map(os.path.abspath, sys.argv[1:]))
