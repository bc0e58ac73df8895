#!/usr/bin/python3
"""Evaluations a second of a fabric's pattern search, on a take that cameras made: one thread, two, two workers
with a spool, two ranks of Open MPI where there is one. Asked: two are 1.8 times as fast as one.

A search of few evaluations is taken from one of many, so that starting and ending don't count.

  searchfit.py BUILD DATA      BUILD: the build; DATA: tests/data

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

build, data = map(os.path.abspath, sys.argv[1:])
TOOL = os.path.join(build, 'tools/gst-cloth-fit-1.0')
TAKE = os.path.join(data, 'take_drag')
FEW, MANY = 40, 240
MODEL = {'version': 1, 'areal_density': 0.18, 'stretch': {'warp': 60, 'weft': 60}, 'shear': 15,
         'bending': {'warp': 2e-5, 'weft': 2e-5}, 'damping': {'mass': 0.5, 'stiffness': 0.001},
         'free': [{'name': 'stretch.warp', 'range': [5, 1000]}, {'name': 'stretch.weft', 'range': [5, 1000]},
                  {'name': 'shear', 'range': [1, 300]}, {'name': 'damping.mass', 'range': [0.01, 20]}]}
MPI = ['mpirun', '--oversubscribe', '--mca', 'btl', 'tcp,self', '-n', '2']


def search(folder, evaluations, workers, threads):
    """Seconds, and how many evaluations were decided on; workers: command lines that precede those of workers."""
    command = [TOOL, 'search', TAKE, '--model', folder + '/model.json']
    manage = command + ['--output', folder + '/out', '--evaluations', str(evaluations)]
    start = time.monotonic()
    if workers:
        spool = ['--spool', folder + '/spool']
        started = [subprocess.Popen(prefix + command + spool + ['--worker', '--threads', '1'],
                                    stdout=subprocess.DEVNULL) for prefix in workers]
        subprocess.run(manage + spool, check=True, stdout=subprocess.DEVNULL)
        for process in started:
            process.wait()
        shutil.rmtree(folder + '/spool')
    else:
        subprocess.run(manage + ['--threads', str(threads)], check=True, stdout=subprocess.DEVNULL)
    seconds = time.monotonic() - start
    with open(folder + '/out/fit.json', encoding='utf-8') as file:
        told = json.load(file)
    shutil.rmtree(folder + '/out')
    return seconds, told['search']['evaluations'], [number['value'] for number in told['numbers']]


def main(folder):
    with open(folder + '/model.json', 'w', encoding='utf-8') as file:
        json.dump(MODEL, file)
    os.environ.setdefault('OMPI_ALLOW_RUN_AS_ROOT', '1')
    os.environ.setdefault('OMPI_ALLOW_RUN_AS_ROOT_CONFIRM', '1')
    one, first = None, None
    for what, workers, threads in (('1 thread', [], 1), ('2 threads', [], 2), ('2 workers with a spool', [[], []], 1),
                                   ('2 ranks of Open MPI with a spool', [MPI] if shutil.which('mpirun') else None, 1)):
        if workers is None:
            continue
        few, many = (search(folder, n, workers, threads) for n in (FEW, MANY))
        rate = (many[1] - few[1]) / (many[0] - few[0])
        one, first = one or rate, first or many[2]
        print('%-34s %6.1f evaluations/s  × %.2f  %s' % (
            what, rate, rate / one, 'the same numbers' if many[2] == first else 'OTHER NUMBERS'), flush=True)


with tempfile.TemporaryDirectory() as made:
    main(made)
