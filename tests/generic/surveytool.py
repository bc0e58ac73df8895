#!/usr/bin/python3
"""Surveys a list of takes: equal bytes for any number of workers, workers and managers that are
killed, bad lists, foreign spools, a full disk.

  surveytool.py TOOL ROOT

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import jsonschema

tool, root = (os.path.abspath(path) for path in sys.argv[1:])
knit = os.path.join(root, 'pipelines/model-knit.json')
drag = os.path.join(root, 'tests/data/take_drag')
faults = []


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what), flush=True)
    if not true:
        faults.append(what)


def run(folder, *arguments):
    return subprocess.run([tool, *arguments], cwd=folder, capture_output=True, text=True, timeout=280,
                          stdin=subprocess.DEVNULL, env=dict(os.environ, LC_ALL='C.UTF-8'))


def start(folder, *arguments):
    return subprocess.Popen([tool, *arguments], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            stdin=subprocess.DEVNULL, env=dict(os.environ, LC_ALL='C.UTF-8'))


def write(folder, name, text):
    with open(os.path.join(folder, name), 'w', encoding='utf-8') as file:
        file.write(text)


def survey(folder, output, *more):
    return ('survey', 'list.txt', '--model', knit, '--effects', 'air_drag,wind', '--output', output, *more)


def read(folder, output):
    with open(os.path.join(folder, output, 'survey.json'), 'rb') as file:
        return file.read()


def children(pid):
    """Of a process that this test started."""
    with open('/proc/%d/task/%d/children' % (pid, pid), encoding='ascii') as file:
        return [int(word) for word in file.read().split()]


def wait_until(true, seconds=60):
    end = time.monotonic() + seconds
    while not true() and time.monotonic() < end:
        time.sleep(0.01)
    return true()


def entries(folder, name):
    path = os.path.join(folder, name)
    return [entry for entry in os.listdir(path) if entry[0] != '.'] if os.path.isdir(path) else []


def good(folder):
    """The table, held against the diagnoses themselves; 1 and 3 workers."""
    done = run(folder, *survey(folder, 'one', '--workers', '1'))
    expect(done.returncode == 0, 'one worker ' + done.stderr[-300:])
    expect(run(folder, *survey(folder, 'three', '--workers', '3', '--threads', '2')).returncode == 0, 'three workers')
    expect(read(folder, 'one') == read(folder, 'three'), 'equal bytes with three')
    table = json.loads(read(folder, 'one'))
    with open(os.path.join(root, 'docs/survey.schema.json'), encoding='utf-8') as file:
        schema = jsonschema.Draft202012Validator(json.load(file))
    schema.check_schema(schema.schema)
    schema.validate(table)
    expect(not schema.is_valid(dict(table, takes=[])) and not schema.is_valid(dict(table, colour=1)), 'the schema refuses')
    expect([take['name'] for take in table['takes']] == [drag, drag, 'base'], 'takes in the order of the list')
    run(folder, 'diagnose', drag, '--baseline', 'base', '--model', knit, '--effects', 'air_drag,wind', '--output', 'alone')
    with open(os.path.join(folder, 'alone/gap.json'), encoding='utf-8') as file:
        alone = json.load(file)
    first = table['takes'][0]
    for key in 'verdict', 'summary', 'gap_before', 'gap_after', 'noise_floor', 'shrink':
        expect(first[key] == alone[key], 'as diagnose says: ' + key)
    expect(first['sha256'] == alone['inputs'][0]['sha256'], 'the hash of the take')
    with open(os.path.join(folder, 'one/spool', first['report']), encoding='utf-8') as file:
        expect('</html>' in file.read(), 'a report')
    # The mean by hand: weights of both kinds, where the effect was accepted.
    row = table['effects'][0]
    fitted = [(p['value'], p['sigma']) for take in table['takes'] for effect in take['effects']
              if effect['name'] == 'air_drag' and effect['accepted'] for p in effect['parameters']]
    weights = [1 / sigma ** 2 for _, sigma in fitted]
    mean = sum(w * v for w, (v, _) in zip(weights, fitted)) / sum(weights)
    pooled = row['parameters'][0]
    expect(row['name'] == 'air_drag' and row['accepted'] == pooled['takes'] == 2 and row['tested'] == 3, str(row))
    expect(pooled['spread'] == 0 and math.isclose(pooled['value'], mean, rel_tol=1e-5) and
           math.isclose(pooled['sigma'], sum(weights) ** -0.5, rel_tol=1e-5), 'the mean: %g' % mean)
    expect(re.search(r'^air_drag +2 of 3 +coefficient \d', done.stdout, re.M) and
           re.search(r'^base +\w+ ', done.stdout, re.M) and done.stdout.endswith('\none/survey.json\n'), done.stdout)
    expect([line.split()[0] for line in done.stderr.splitlines()] == ['0%', '33%', '66%', '100%'], done.stderr)
    # once done, a survey is not done again unless it is asked to be
    again = run(folder, *survey(folder, 'one'))
    expect(again.returncode == 1 and 'is a spool already' in again.stderr, again.stderr.strip())
    os.remove(os.path.join(folder, 'one/survey.json'))
    begin = time.monotonic()
    again = run(folder, *survey(folder, 'one', '--workers', '0', '--resume'))
    expect(again.returncode == 0 and read(folder, 'one') == read(folder, 'three') and time.monotonic() - begin < 3,
           'resumed from what is there')


def killed(folder):
    """A worker is killed at its job, then the manager; what they did is not done again."""
    manager = start(folder, *survey(folder, 'killed', '--workers', '1'))
    expect(wait_until(lambda: entries(folder, 'killed/spool/running')), 'a job runs')
    worker = children(manager.pid)[0]
    diagnosis = children(worker)
    os.kill(worker, signal.SIGKILL)
    expect(wait_until(lambda: all(not os.path.exists('/proc/%d' % pid) for pid in diagnosis), 5),
           'its diagnosis ends with it')
    expect(wait_until(lambda: entries(folder, 'killed/spool/done')), 'another worker takes the job')
    done = entries(folder, 'killed/spool/done')
    stamps = {name: os.stat(os.path.join(folder, 'killed/spool/done', name)).st_mtime_ns for name in done}
    left = children(manager.pid)
    manager.kill()
    manager.communicate()
    expect(wait_until(lambda: all(not os.path.exists('/proc/%d' % pid) for pid in left), 5),
           'workers of the host end with their manager')
    refused = run(folder, *survey(folder, 'killed', '--workers', '1'))
    expect(refused.returncode == 1 and 'a spool already' in refused.stderr, refused.stderr.strip())
    resumed = run(folder, *survey(folder, 'killed', '--workers', '2', '--resume'))
    expect(resumed.returncode == 0 and read(folder, 'killed') == read(folder, 'three'), 'equal bytes ' + resumed.stderr)
    expect(all(os.stat(os.path.join(folder, 'killed/spool/done', name)).st_mtime_ns == stamp
               for name, stamp in stamps.items()), 'nothing that was done is done again')


def apart(folder):
    """Workers that are started by themselves, one of them before its manager."""
    early = start(folder, 'survey', '--worker', '--spool', 'jobs')
    time.sleep(0.5)
    manager = start(folder, *survey(folder, 'apart', '--spool', 'jobs', '--workers', '0'))
    expect(wait_until(lambda: os.path.exists(os.path.join(folder, 'jobs/manager.json'))), 'a manager')
    second = run(folder, *survey(folder, 'other', '--spool', 'jobs', '--resume'))
    expect(second.returncode == 1 and 'is managed by process %d on ' % manager.pid in second.stderr, second.stderr.strip())
    late = start(folder, 'survey', '--worker', '--spool', 'jobs')
    expect(manager.wait(200) == 0 and early.wait(20) == 0 and late.wait(20) == 0, 'all end')
    for process in manager, early, late:
        process.communicate()
    expect(read(folder, 'apart') == read(folder, 'three'), 'equal bytes')
    # Ctrl-C: nothing goes on, and it can be resumed
    manager = start(folder, *survey(folder, 'stopped', '--workers', '1'))
    expect(wait_until(lambda: entries(folder, 'stopped/spool/running')), 'a job runs')
    left = children(manager.pid)
    manager.send_signal(signal.SIGINT)
    out, error = manager.communicate(timeout=20)
    expect(manager.returncode == 1 and 'go on with --resume' in error and not out, error.strip()[-100:])
    expect(not any(os.path.exists('/proc/%d' % pid) for pid in left), 'no worker is left')


def bad(folder):
    write(folder, 'some.txt', '%s --baseline base\nnowhere\n' % drag)
    done = run(folder, 'survey', 'some.txt', '--model', knit, '--effects', 'wind', '--output', 'some')
    table = json.loads(read(folder, 'some'))
    with open(os.path.join(root, 'docs/survey.schema.json'), encoding='utf-8') as file:
        jsonschema.Draft202012Validator(json.load(file)).validate(table)
    expect(done.returncode == 1 and '1 of 2 takes could not be diagnosed' in done.stderr and
           'nowhere” is no take' in table['takes'][1]['error'] and table['takes'][0]['verdict'], done.stderr.strip()[-100:])
    # of a wrong line the table says what is wrong, not how to use a command
    write(folder, 'twice.txt', '%s --hold-out %s\n' % (drag, drag))
    run(folder, 'survey', 'twice.txt', '--model', knit, '--output', 'twice')
    fault = json.loads(read(folder, 'twice'))['takes'][0]['error']
    expect('is given twice' in fault and '--help' not in fault, fault)
    # mended, only that one is diagnosed
    shutil.copytree(os.path.join(folder, 'base'), os.path.join(folder, 'nowhere'))
    done = run(folder, 'survey', 'some.txt', '--model', knit, '--effects', 'wind', '--output', 'some', '--resume')
    expect(done.returncode == 0 and done.stdout.count('failed') == 0, 'mended and resumed')
    for change, text in [((), 'other inputs'), (('--model', 'm.json'), 'other inputs')]:
        shutil.copy(os.path.join(root, 'pipelines/model-windy.json'), os.path.join(folder, 'm.json'))
        done = run(folder, 'survey', 'some.txt', '--model', knit, '--output', 'some', '--resume', '--seed', '3', *change)
        expect(done.returncode == 1 and text in done.stderr, done.stderr.strip())
    spool = os.path.join(folder, 'some/spool/spool.json')
    with open(spool, encoding='utf-8') as file:
        text = file.read()
    write(folder, 'some/spool/spool.json', text.replace('"version": 1', '"version": 7'))
    for arguments in (('survey', 'some.txt', '--model', knit, '--effects', 'wind', '--output', 'some', '--resume'),
                      ('survey', '--worker', '--spool', 'some/spool')):
        done = run(folder, *arguments)
        expect(done.returncode == 1 and 'version 7 is another program' in done.stderr, done.stderr.strip())
    for lines, text in [('', 'no take in it'), ('# a\n\n', 'no take in it'), ('a b\n', 'line 1: “b” is a second take'),
                        ('a\n--baseline b\n', 'line 2: there is no take'), ('a --baseline\n', 'needs a value'),
                        ('a --baseline --model m\n', '--baseline needs a value'), ('"a\n', 'line 1: '),
                        ('a --colour b\n', '“--colour” is no option'), ('a --model m m\n', 'twice'),
                        ('a --effects x\n', '--effects: '), ('a --model none.json\n', 'none.json'),
                        ('a --simulator rm\n', '“--simulator” is no option')]:
        write(folder, 'bad.txt', lines)
        done = run(folder, 'survey', 'bad.txt', '--model', knit, '--output', 'x')
        expect(done.returncode == 1 and text in done.stderr and not os.path.exists(os.path.join(folder, 'x')),
               '%r: %s' % (lines, done.stderr.strip()))
    for arguments, code, text in [
            ((), 2, 'name one list'), (('a', 'b'), 2, 'name one list'), (('list.txt',), 2, '--output DIR'),
            (('list.txt', '--output', 'x'), 1, 'has no model'), (('none.txt', '--output', 'x', '--model', knit), 1, 'none.txt'),
            (('list.txt', '--output', 'x', '--model', 'none'), 1, 'none'), (('--worker',), 2, '--spool DIR'),
            (('list.txt', '--output', 'x', '--effects', 'none'), 2, '--effects'), (('--worker', 'list.txt'), 2, '--worker takes'),
            (('--worker', '--spool', 'x', '--resume'), 2, '--worker takes'), (('list.txt', '--baseline', 'b'), 2, 'takes no --base'),
            (('list.txt', '--output', 'x', '--threads', '-1'), 2, '--threads')]:
        done = run(folder, 'survey', *arguments)
        expect(done.returncode == code and text in done.stderr, '%s: %s' % (arguments, done.stderr.split('\n')[0]))
    done = run(folder, 'diagnose', drag, '--model', knit, '--output', 'x', '--workers', '2')
    expect(done.returncode == 2 and "survey's" in done.stderr, done.stderr.split('\n')[0])


def hostile(folder):
    """A job of somebody else: it can't name a program, an option or where to write."""
    manager = start(folder, *survey(folder, 'hostile', '--workers', '0'))
    spool = os.path.join(folder, 'hostile/spool')
    expect(wait_until(lambda: len(entries(folder, 'hostile/spool/todo')) == 3), 'jobs')
    jobs = [{'take': ['--simulator=touch x']}, {'take': [7]}, {'take': {}}]
    for name, job in zip(sorted(entries(folder, 'hostile/spool/todo')), jobs):
        write(spool, 'todo/' + name, json.dumps(job))
    worker = run(folder, 'survey', '--worker', '--spool', spool)
    out, error = manager.communicate(timeout=60)
    expect(worker.returncode == 0 and manager.returncode == 1 and '3 of 3' in error and
           out.count('“take” must be absolute paths') == 2 and not os.path.exists(os.path.join(folder, 'x')), out + error)


def full(folder):
    """The disk fills up: it is said, the job stays, and once there is room it goes on."""
    disk = os.path.join(folder, 'disk')
    os.mkdir(disk)
    if subprocess.run(['mount', '-t', 'tmpfs', '-o', 'size=400k', 'tmpfs', disk], stderr=subprocess.DEVNULL).returncode:
        print('not tested: a full disk, which only root can make')
        return
    try:
        done = run(folder, *survey(folder, 'full', '--spool', 'disk/spool', '--workers', '2'))
        expect(done.returncode == 1 and 'No space left on device' in done.stderr and 'is given back' in done.stderr and
               'go on with --resume' in done.stderr, done.stderr.strip()[-400:])
        expect(len(entries(disk, 'spool/todo')) + len(entries(disk, 'spool/done')) == 3 and
               not entries(disk, 'spool/failed'), 'no job is lost or failed')
        subprocess.run(['mount', '-o', 'remount,size=64m', disk], check=True)
        done = run(folder, *survey(folder, 'full', '--spool', 'disk/spool', '--workers', '2', '--resume'))
        expect(done.returncode == 0 and read(folder, 'full') == read(folder, 'three'), 'with room it goes on')
    finally:
        subprocess.run(['umount', disk], check=True)


with tempfile.TemporaryDirectory() as scratch:
    run(scratch, 'simulate', knit, '--scene', drag, '--output', 'base')
    write(scratch, 'list.txt', '# three\n%s --baseline base\n%s --simulated base\n\n  base # itself\n' % (drag, drag))
    for part in good, killed, apart, bad, hostile, full:
        part(scratch)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
