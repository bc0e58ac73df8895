#!/usr/bin/python3
"""The contract of docs/own-simulator.md: our own adapter keeps it, and each way to break it is
told with what to do.

  contract.py TOOL ROOT

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import shlex
import subprocess
import sys
import tempfile
import time

import jsonschema

tool, root = (os.path.abspath(path) for path in sys.argv[1:])
scene = os.path.join(root, 'tests/data/take_drag')
faults = []

# A simulator that moves the cloth as a whole by `shift` and does what else it is told.
GOOD = '''
import json, os, shutil, sys, time, numpy
if sys.argv[1] == '--capabilities':
    print(json.dumps(CAPABILITIES)); sys.exit(0)
folder = sys.argv[1]
p = json.load(open(folder + '/parameters.json'))
x = numpy.load(folder + '/scene/positions.npy')
t = numpy.load(folder + '/scene/times.npy')
assert numpy.isfinite(x[0]).all() and numpy.isnan(x[1:]).all() and len(t) == len(x)
x[:] = x[0] + p['shift']
shutil.copytree(folder + '/scene', folder + '/simulated')
os.remove(folder + '/simulated/states.npy')
BAD
numpy.save(folder + '/simulated/positions.npy', x)
numpy.save(folder + '/simulated/times.npy', t)
'''
SHIFT = {'name': 'shift', 'unit': 'm', 'value': 0.01, 'range': [0, 1]}


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what))
    if not true:
        faults.append(what)


def check(folder, command, *arguments):
    start = time.monotonic()
    done = subprocess.run([tool, 'check-simulator', command, '--scene', scene, *arguments],
                          cwd=folder, capture_output=True, text=True, timeout=120,
                          stdin=subprocess.DEVNULL,
                          env=dict(os.environ, LC_ALL='C.UTF-8', TMPDIR=folder, PATH=os.pathsep.join(
                              [os.path.dirname(tool), '/usr/bin', '/bin'])))
    left = [name for name in os.listdir(folder) if name.startswith('gst-cloth-gap-')]
    expect(not left, 'no folder is left %s' % left)
    done.seconds = time.monotonic() - start
    return done


def script(folder, bad='', capabilities=None, text=GOOD):
    path = os.path.join(folder, 'my simulator.py')
    said = {'version': 1, 'simulator': 'mine', 'parameters': [SHIFT]} if capabilities is None \
        else capabilities
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text.replace('CAPABILITIES', repr(said)).replace('BAD', bad))
    return '%s -I %s' % (sys.executable, shlex.quote(path))


def refuse(folder, what, words, *arguments, **kind):
    done = check(folder, script(folder, **kind), *arguments)
    said = (done.stdout + done.stderr).strip()
    expect(done.returncode == 1 and all(word in said for word in words),
           '%s: %s' % (what, said[-300:]))
    return done


def schema_of(name):
    with open(os.path.join(root, 'docs', name), encoding='utf-8') as file:
        text = json.load(file)
    jsonschema.Draft202012Validator.check_schema(text)
    return jsonschema.Draft202012Validator(text)


def keep(folder):
    command = os.path.join(root, 'pipelines/simulators/cloth.py')
    said = json.loads(subprocess.run([command, '--capabilities'], capture_output=True, check=True,
                                     text=True).stdout)
    capabilities = schema_of('simulator-capabilities.schema.json')
    capabilities.validate(said)
    done = check(folder, command)
    lines = done.stdout.splitlines()
    expect(done.returncode == 0 and len(lines) == 6 and 'gst-cloth' in lines[0] and
           'differ by 0 mm' in lines[0] and all(' moves the cloth by ' in line for line in lines[1:]),
           'cloth.py: %s%s' % (done.stdout, done.stderr))
    # the folder of a run is what the schema and the page say
    done = check(folder, script(folder, bad="open('asked.json', 'w').write(json.dumps(p))"))
    with open(os.path.join(folder, 'asked.json'), encoding='utf-8') as file:
        asked = json.load(file)
    schema_of('simulator-parameters.schema.json').validate(asked)
    # a tenth of the range up, all vertices by as much along each axis
    expect(asked == {'shift': 0.11} and done.returncode == 0 and
           'shift                    0.01 to 0.11 m moves the cloth by 173 mm' in done.stdout,
           'in the caller’s folder: %s' % done.stdout)
    several = {key: value for key, value in SHIFT.items() if key != 'unit'}
    several['is'] = ['stretch.warp', 'stretch.weft']
    done = check(folder, script(folder, capabilities={'version': 1, 'simulator': 'mine', 'parameters': [several]}))
    expect('0.01 to 0.11 moves the cloth by 173 mm, is stretch.warp, stretch.weft\n' in done.stdout,
           'a number without unit that is several: ' + done.stdout)
    done = check(folder, script(folder, capabilities={
        'version': 1, 'simulator': 'mine', 'parameters': [dict(SHIFT, range=None)]}))
    expect(done.returncode == 0 and 'fixed' in done.stdout, 'a setting is left alone')
    for bad in ({}, {'version': 1, 'simulator': 'a', 'parameters': [{'name': 'b'}]},
                {'version': 1, 'simulator': 'a', 'parameters': [dict(SHIFT, mass=1)]}):
        expect(not capabilities.is_valid(bad), 'the schema refuses %s' % bad)


def break_runs(folder):
    refuse(folder, 'fails', ['exit code 3', 'out of licences', 'mine'],
           bad="print('out of licences'); sys.exit(3)")
    refuse(folder, 'killed', ['signal 11'], bad='os.kill(os.getpid(), 11)')
    # what it starts goes with it
    done = refuse(folder, 'hangs', ['not done after 1 s', '--run-seconds'], '--run-seconds', '1',
                  bad="import subprocess; subprocess.run(['sleep', '60.125'])")
    expect(done.seconds < 30, '%.1f s' % done.seconds)
    with os.popen('ps -eo args') as processes:
        expect('sleep 60.125' not in processes.read(), 'nothing goes on')
    refuse(folder, 'NaN', ['blew up', '0.1 s', 'vertex 7'], bad='x[5, 7] = numpy.nan')
    refuse(folder, 'infinite', ['frame 5', 'vertex 7'], bad='x[5, 7] = numpy.inf')
    refuse(folder, 'diverges', ['blew up', 'm apart'], bad='x[40:, ::2] += 1e4')
    refuse(folder, 'another mesh', ['9×9', 'same mesh'],
           bad="q = folder + '/simulated/take.json'; j = json.load(open(q)); "
               "j['grid']['rows'] = 8; json.dump(j, open(q, 'w')); x = x[:, :72]")
    refuse(folder, 'half a mesh', ['positions.npy'], bad='x = x[:, :72]')
    refuse(folder, 'another size', ['0.8'],
           bad="q = folder + '/simulated/take.json'; j = json.load(open(q)); "
               "j['grid']['width_m'] = 0.8; json.dump(j, open(q, 'w'))")
    refuse(folder, 'no take', ['no take', 'simulated/take.json'], bad='sys.exit(0)',
           text=GOOD.replace("shutil.copytree(folder + '/scene', folder + '/simulated')", 'BAD'))
    refuse(folder, 'text as positions', ['is no take'],
           text=GOOD.replace("numpy.save(folder + '/simulated/positions.npy', x)",
                             "open(folder + '/simulated/positions.npy', 'w').write('x')"))
    refuse(folder, 'half of the time', ['scene/times.npy'],
           bad="x, t = x[:30], t[:30]; c = numpy.load(folder + '/simulated/clamps.npy'); "
               "numpy.save(folder + '/simulated/clamps.npy', c[:30])")
    refuse(folder, 'milliseconds', ['scene/times.npy'], bad='t = 1000 * t')
    refuse(folder, 'ignores a parameter', ['changing “shift” from 0.01 to 0.11 changed nothing',
                                           'parameters.json', '1 of 1'], bad='x[:] = 0.25')
    refuse(folder, 'refuses its range', ['exit code 1', 'shift = 0.11 m'],
           bad="assert p['shift'] < 0.1")


def break_capabilities(folder):
    def said(parameters, **more):
        return dict({'version': 1, 'simulator': 'mine', 'parameters': parameters}, **more)

    for what, capabilities, words in (
            ('another version', said([SHIFT], version=2), ['version 2']),
            ('an unknown key', said([dict(SHIFT, effect='drag')]), ['“effect”', 'scale']),
            ('no parameters', said([]), ['list the numbers']),
            ('no name', said([{'value': 1}]), ['no “name”']),
            ('no value', said([{'name': 'a'}]), ['“a” has no “value”']),
            ('a name twice', said([SHIFT, SHIFT]), ['two parameters', '“shift”']),
            ('a range that ends before it begins', said([dict(SHIFT, range=[1, 0])]), ['“range”']),
            ('a value outside of it', said([dict(SHIFT, value=2)]), ['outside of its range']),
            ('an effect that is none', said([dict(SHIFT, **{'is': 'effects.air_drug.coefficient'})]),
             ['“shift”', 'air_drug']),
            ('an effect without a parameter', said([dict(SHIFT, **{'is': 'effects.air_drag'})]),
             ['“shift”']),
            ('one number twice', said([dict(SHIFT, **{'is': 'shear'}),
                                       dict(SHIFT, name='b', **{'is': ['shear']})]), ['“shear”', '“b”']),
            ('a scale of 0', said([dict(SHIFT, scale=0)]), ['“scale”']),
            ('a name of two lines', said([dict(SHIFT, name='a\nb')]), ['one line'])):
        refuse(folder, what, words, capabilities=capabilities)
    refuse(folder, 'prints more than JSON', ['not JSON'],
           text=GOOD.replace('print(json', "print('Welcome!'); print(json"))
    refuse(folder, 'prints nothing', ['0 bytes'], text='')
    refuse(folder, 'knows no capabilities', ['--capabilities', 'exit code 1', 'KeyError'],
           text='raise KeyError')
    for command, words in (('./is-not-there', ['is-not-there', 'can’t be started']),
                           ('"open', ['open']), ('', ['--simulator'])):
        done = check(folder, command)
        expect(done.returncode == 1 and any(word in done.stderr.replace("'", '’') for word in words),
               'command %r: %s' % (command, done.stderr))
    for arguments in ((), ('--run-seconds', '0'), ('--format', 'json'), ('a', 'b')):
        done = subprocess.run([tool, 'check-simulator', *arguments, *(['x'] if arguments[:1] else [])],
                              capture_output=True, text=True, timeout=60)
        expect(done.returncode == 2, 'bad usage: %s' % done.stderr.splitlines()[:1])


with tempfile.TemporaryDirectory() as parent:
    keep(parent)
    break_runs(parent)
    break_capabilities(parent)
print('%d faults' % len(faults))
sys.exit(1 if faults else 0)
