#!/usr/bin/python3
"""Kills a pipeline that records and finishes its recording with gst-cloth-take-1.0.

  taketool.py TAKETOOL PATTERNTOOL TESTDATA

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import glob
import os
import re
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time

import numpy

tool, pattern, data = (os.path.abspath(path) for path in sys.argv[1:])
drop = os.path.join(data, 'take_drop')
positions = numpy.load(os.path.join(drop, 'positions.npy'))
faults = []


def run(*command, cwd=None, **more):
    return subprocess.run(command, cwd=cwd, **more, stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=120, env=dict(os.environ, LC_ALL='C.UTF-8'))


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what))
    if not true:
        faults.append(what)


def read_pc2(path):
    with open(path, 'rb') as file:
        head = file.read(32)
        points, samples = (int.from_bytes(head[i:i + 4], 'little') for i in (16, 28))
        return numpy.frombuffer(file.read(), '<f4').reshape(samples, points, 3)


def record(folder, name):
    """Records in real time and is killed when the first frames are on the disk."""
    child = subprocess.Popen(
        ['gst-launch-1.0', 'meshsrc', 'location=' + drop, '!', 'meshsink', 'location=' + name,
         'sync=true'], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, text=True)
    base = os.path.basename(name)
    parts = (os.path.join(folder, name, '.take.json.part-*', 'positions.npy')
             if name.endswith('.take') else os.path.join(folder, '.%s.part-*' % base, '*.pc2'))
    size = 128 + 3 * 12 * positions.shape[1]
    older = set(glob.glob(parts))
    until = time.monotonic() + 60
    while child.poll() is None and time.monotonic() < until:
        time.sleep(0.005)
        if any(os.path.getsize(path) > size for path in set(glob.glob(parts)) - older):
            child.send_signal(signal.SIGKILL)
            break
    if child.poll() is None and time.monotonic() >= until:
        child.terminate()
    said = child.communicate(timeout=60)[0]
    expect(child.returncode == -signal.SIGKILL, name + ' is killed')
    return said


def killed(folder):
    for name in 'c.take', 'c.obj':
        expect('interrupted' not in record(folder, name), 'it tells of nothing')
        head = os.path.join(folder, name, 'take.json' if name == 'c.take' else '').rstrip('/')
        expect(not os.path.exists(head), 'nothing is there')
        again = run('gst-launch-1.0', 'meshsrc', 'location=' + name, '!', 'fakesink', cwd=folder)
        expect(again.returncode != 0, 'it is not read')
        # a take is found from the folder that it lies in
        done = run(tool, 'recover', '.' if name == 'c.take' else name, cwd=folder)
        expect(done.returncode == 0 and 'frames kept' in done.stdout, done.stdout.strip())
        kept = int(done.stdout.split(': ')[1].split()[0])
        got = (numpy.load(os.path.join(folder, 'c.take/positions.npy')) if name == 'c.take'
               else read_pc2(os.path.join(folder, 'c.obj'.replace('obj', 'pc2'))))
        truth = positions[:kept].astype(numpy.float32)
        seen = ~numpy.isnan(truth)
        expect(2 <= kept < len(positions) and got.shape == truth.shape and
               (got[seen] == truth[seen]).all(), '%d frames, to the bit' % kept)
        again = run('gst-launch-1.0', '-q', 'meshsrc', 'location=' + name, '!', 'fakesink',
                    cwd=folder)
        expect(again.returncode == 0, 'it is read ' + again.stderr[-200:])
        done = run(tool, 'recover', name, cwd=folder)
        expect(done.returncode == 0 and 'nothing to recover' in done.stdout, 'once')
        expect(not glob.glob(os.path.join(folder, '**/.*part*'), recursive=True), 'nothing stays')


def finished(folder):
    """What is there is not replaced without being told."""
    with open(os.path.join(folder, 'c.pc2'), 'rb') as file:
        before = file.read()
    record(folder, 'c.obj')
    done = run(tool, 'recover', '.', cwd=folder)
    with open(os.path.join(folder, 'c.pc2'), 'rb') as file:
        expect(done.returncode == 1 and '--overwrite' in done.stderr and
               'c.obj' in done.stderr and file.read() == before, done.stderr.strip())
    said = record(folder, 'c.obj')
    expect('was interrupted' in said and 'gst-cloth-take-1.0 recover' in said, 'meshsink tells of it')
    done = run(tool, 'recover', '.', cwd=folder)
    expect(done.returncode == 1 and 'is older' in done.stderr, 'one of the two is older')
    done = run(tool, 'recover', '--overwrite', 'c.obj', cwd=folder)
    expect(done.returncode == 1 and 'frames kept' in done.stdout and 'is older' in done.stderr,
           done.stdout.strip())
    # by the path that was told
    older = done.stderr.split('“')[1].split('”')[0]
    done = run(tool, 'recover', '--overwrite', older, cwd=folder)
    expect(done.returncode == 0 and 'frames kept' in done.stdout, done.stdout.strip())


def hidden(folder):
    """Remains without a frame don't hide older ones; another user's are named, not touched."""
    record(folder, 'n.obj')
    newer = os.path.join(folder, '.n.obj.part-newer0')
    os.makedirs(os.path.join(newer, 'new'))
    with open(os.path.join(newer, 'recording'), 'w', encoding='ascii') as file:
        file.write('gst-cloth recording 1\n6\n')
    done = run(tool, 'recover', '.', cwd=folder)
    expect(done.returncode == 0 and 'no whole frame' in done.stdout and 'frames kept' in done.stdout,
           done.stdout.strip())
    if os.geteuid() == 0:
        os.makedirs(os.path.join(newer, 'new'))
        os.chown(newer, 1, 1)
        done = run(tool, 'recover', '.', cwd=folder)
        expect(done.returncode == 1 and "another user's" in done.stderr and os.path.isdir(newer),
               done.stderr.strip())
        shutil.rmtree(newer)


def full(folder):
    """A disk that becomes full, here a limit of the file's size: what was recorded is kept."""
    size = 128 + 14 * 12 * positions.shape[1]
    done = run('gst-launch-1.0', '-q', 'meshsrc', 'location=' + drop, '!', 'meshsink', 'location=f.obj',
               cwd=folder, restore_signals=False,
               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)))
    kept = re.search(r'(\d+) frames are kept: “gst-cloth-take-1.0 recover f.obj”', done.stderr)
    expect(done.returncode == 1 and kept and int(kept[1]) >= 2 and
           not os.path.exists(os.path.join(folder, 'f.obj')), done.stderr.strip()[-300:])
    done = run(tool, 'recover', 'f.obj', cwd=folder)
    got = read_pc2(os.path.join(folder, 'f.pc2'))
    truth = positions[:len(got)].astype(numpy.float32)
    seen = ~numpy.isnan(truth)
    expect(done.returncode == 0 and len(got) >= int(kept[1]) and (got[seen] == truth[seen]).all(),
           done.stdout.strip())


def usage(folder):
    for words in ['recover'], ['import'], ['recover', '--bogus', '.'], ['recover', '']:
        done = run(tool, *words, cwd=folder)
        expect(done.returncode == 2 and '--help' in done.stderr, ' '.join(words))
    done = run(tool, 'recover', 'nosuch.obj', cwd=folder)
    expect(done.returncode == 1 and 'nothing of that name' in done.stderr, done.stderr.strip())
    done = run(tool, 'recover', 'nowhere/c.obj', cwd=folder)
    expect(done.returncode == 1 and 'nowhere' in done.stderr, done.stderr.strip())
    done = run(tool, 'recover', folder, cwd=folder)
    expect(done.returncode == 0 and 'nothing to recover' in done.stdout, done.stdout.strip())


def devices(folder):
    """Where a name is asked for, a device or a pipe is refused, and stays."""
    record_to = ['gst-launch-1.0', 'meshsrc', 'location=' + drop, '!', 'meshsink']
    m_array = [pattern, 'm-array', '--columns', '6', '--rows', '6', '--pitch', '20mm', '--output']
    refused = 'is a device, a pipe or a socket: name a regular file'
    pipes = [os.path.join(folder, name) for name in ('x.pdf', 'x.svg', 'x.csv', 'x')]
    for pipe in pipes:
        os.mkfifo(pipe)
    before = sorted(os.listdir(folder))
    for command, told, code in (
            ([pattern, 'checker', '--output', pipes[0]], refused, 1),
            (m_array + [pipes[1]], refused, 1),
            (record_to + ['location=' + pipes[2]], refused, 1),
            (record_to + ['location=' + pipes[3]], refused, 1),
            (record_to + ['location=/dev/null'], refused, 1),
            (record_to + ['location=' + pipes[3], 'format=take'], 'Not a directory', 1),
            (record_to + ['location=/dev/null', 'format=take'], 'Not a directory', 1)):
        done = run(*command, cwd=folder)
        expect(done.returncode == code and told in done.stderr,
               ' '.join([os.path.basename(command[0])] + command[1:]) + ': ' + done.stderr[-300:])
    expect(sorted(os.listdir(folder)) == before and
           all(stat.S_ISFIFO(os.stat(pipe).st_mode) for pipe in pipes), 'the pipes stay, alone')
    expect(stat.S_ISCHR(os.stat('/dev/null').st_mode) and not os.path.exists('/dev/null.obj'),
           'the device stays')


with tempfile.TemporaryDirectory(prefix='cloth-taketool-') as scratch:
    killed(scratch)
    finished(scratch)
    hidden(scratch)
    full(scratch)
    usage(scratch)
    devices(scratch)
sys.exit(1 if faults else 0)
