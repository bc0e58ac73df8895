#!/usr/bin/python3
"""gst-cloth-fit-1.0 search: numbers of a simulated cloth are found without derivatives, the same for any number
of threads or workers, whoever is killed; and what it refuses.

  searchtool.py FIT_TOOL GAP_TOOL TEST_DATA

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

tool, gap_tool, data = sys.argv[1:]
folder = tempfile.mkdtemp(prefix='cloth-search-')
faults = []
TRUTH = {'stretch': 90., 'damping': 0.8}


def check(condition, text):
    print(('ok    ' if condition else 'FAULT ') + text)
    if not condition:
        faults.append(text)


def model(stretch, damping, free):
    return {'version': 1, 'areal_density': 0.2, 'stretch': {'warp': stretch, 'weft': stretch}, 'shear': 30,
            'bending': {'warp': 2e-5, 'weft': 2e-5}, 'damping': {'mass': damping, 'stiffness': 1e-3},
            'free': [{'name': 'stretch.warp', 'range': [20, 400]},
                     {'name': 'damping.mass', 'range': [0.1, 5]}] if free else []}


def write(name, what):
    path = os.path.join(folder, name)
    with open(path, 'w', encoding='utf-8') as file:
        json.dump(what, file)
    return path


def read(*path):
    with open(os.path.join(folder, *path), encoding='utf-8') as file:
        return file.read()


def command(*arguments):
    return [tool, 'search', take, *arguments]


def run(*arguments):
    return subprocess.run(command(*arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          timeout=250, encoding='utf-8', env=dict(os.environ, LC_ALL='C.UTF-8'), check=False)


def start(*arguments):
    return subprocess.Popen(command(*arguments), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def wait_for(what, folder_, least):
    for _ in range(3000):
        if os.path.isdir(folder_) and sum(
                1 for name in os.listdir(folder_) if not name.startswith('.')) >= least:
            return
        time.sleep(0.02)
    check(False, what)


take = os.path.join(folder, 'take')
subprocess.run([gap_tool, 'simulate', write('truth.json', model(TRUTH['stretch'], TRUTH['damping'], False)),
                '--scene', data + '/take_drag', '--output', take], check=True, stdout=subprocess.DEVNULL)
guess = write('guess.json', model(60, 0.4, True))

# Numbers that are known, whatever the number of threads.
for threads in '1', '2':
    done = run('--model', guess, '--output', folder + '/threads' + threads, '--threads', threads)
    check(done.returncode == 0 and 'converged' in done.stdout, '%s threads: %s' % (
        threads, done.stderr or done.stdout.split('\n')[-2]))
numbers = {x['name']: x for x in json.loads(read('threads1', 'fit.json'))['numbers']}
for name, truth in (('stretch.warp', TRUTH['stretch']), ('damping.mass', TRUTH['damping'])):
    check(abs(numbers[name]['value'] / truth - 1) < 0.1 and numbers[name]['sigma'] is None,
          '%s: %.3g, truth %g' % (name, numbers[name]['value'], truth))
for name in 'fit.json', 'search.log', 'fitted.json':
    check(read('threads1', name) == read('threads2', name), name + ' is the same for 1 and 2 threads')

# A spool whose worker and manager are killed.
spool = os.path.join(folder, 'spool')
manager = start('--model', guess, '--output', folder + '/spooled', '--spool', spool)
worker = start('--model', guess, '--spool', spool, '--worker')
wait_for('no result comes', os.path.join(spool, 'done'), 3)
worker.kill()
worker.wait()
manager.kill()
manager.wait()
workers = [start('--model', guess, '--spool', spool, '--worker') for _ in range(2)]
done = run('--model', guess, '--output', folder + '/spooled', '--spool', spool, '--resume')
check(done.returncode == 0, 'after SIGKILL of both it is resumed ' + done.stderr)
check([one.wait(timeout=60) for one in workers] == [0, 0], 'workers end')
for name in 'fit.json', 'search.log':
    check(read('threads1', name) == read('spooled', name), name + ' is the same from a spool')

# As they come: another order, which its log makes again.
done = run('--model', guess, '--output', folder + '/come', '--as-they-come', '--threads', '2')
check(done.returncode == 0, 'as they come ' + done.stderr)
done = run('--model', guess, '--output', folder + '/again', '--as-they-come', '--replay',
           folder + '/come/search.log')
check(done.returncode == 0 and read('come', 'fit.json') == read('again', 'fit.json')
      and read('come', 'search.log') == read('again', 'search.log'), 'is replayed ' + done.stderr)

done = run('--model', guess, '--output', folder + '/few', '--evaluations', '5')
check(done.returncode == 0 and json.loads(read('few', 'fit.json'))['search']['ended'] == 'limit'
      and 'ended at --evaluations' in done.stdout, 'a limit is said')

# A guess outside of its range begins at the end of it, as that of a fit may.
outside = model(60, 0.4, True)
outside['free'][0]['range'] = [70, 400]
done = run('--model', write('outside.json', outside), '--output', folder + '/outside', '--evaluations', '3')
check(done.returncode == 0 and json.loads(read('outside', 'fit.json'))['numbers'][0]['value'] >= 69.99,
      'a guess outside of its range ' + done.stderr.strip()[-100:])

# A worker of other numbers would give other values.
other = write('other.json', model(61, 0.4, True))
spool = os.path.join(folder, 'other')
manager = start('--model', guess, '--output', folder + '/spooled', '--spool', spool)
wait_for('no job comes', os.path.join(spool, 'todo'), 1)
for code, says, arguments in (
        (1, 'give what its manager was given', ('--model', other, '--spool', spool, '--worker')),
        (1, 'give what its manager was given', ('--model', guess, '--spool', spool, '--worker', '--seed', '1')),
        # neither another recording's values, nor none
        (1, 'of something else', ('--model', guess, '--output', folder + '/replayed', '--replay',
                                  folder + '/threads1/search.log', '--seed', '1')),
        (1, 'no log of a search', ('--model', guess, '--output', folder + '/replayed', '--replay', guess)),
        (2, "manager's", ('--model', guess, '--spool', spool, '--worker', '--evaluations', '5')),
        (2, '--output', ('--model', guess)),
        (2, '--spool', ('--model', guess, '--worker')),
        (2, '--spool', ('--model', guess, '--output', folder + '/x', '--resume')),
        (2, 'manager', ('--model', guess, '--spool', spool, '--worker', '--output', folder + '/x')),
        (2, '--evaluations', ('--model', guess, '--output', folder + '/x', '--evaluations', '0')),
        (1, '--replay', ('--model', guess, '--output', folder + '/x', '--replay', guess)),
        (1, '--replay', ('--model', guess, '--output', folder + '/x', '--replay', folder + '/none')),
        (1, 'no free numbers', ('--model', folder + '/truth.json', '--output', folder + '/x'))):
    done = run(*arguments)
    check(done.returncode == code and says in done.stderr and 'CRITICAL' not in done.stderr,
          'refused: ' + done.stderr.strip())
manager.send_signal(signal.SIGTERM)
manager.wait()
# its points have numbers of their own
done = run('--model', guess, '--output', folder + '/x', '--spool', spool, '--resume', '--as-they-come')
check(done.returncode == 1 and 'options' in done.stderr, 'refused: ' + done.stderr.strip())
done = subprocess.run([tool, 'fit', take, '--model', guess, '--output', folder + '/x', '--resume'],
                      capture_output=True, encoding='utf-8', check=False)
check(done.returncode == 2 and 'search' in done.stderr, 'refused: ' + done.stderr.strip())

shutil.rmtree(folder)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
