#!/usr/bin/python3
"""The blind benchmark of the diagnosis.

  gapbench.py generate DIR   writes DIR/takes, and what was done to them to DIR/sealed
  gapbench.py diagnose DIR   diagnoses DIR/takes, which is all it reads, to DIR/gaps
  gapbench.py score DIR...   opens the labels, measures the gaps with what was really done,
                             writes DIR/score.md and DIR/cases.txt; of several only prints
                             the figures of all cases together
  gapbench.py all DIR        all three

What is there already is not made again, so that a run that was stopped goes on.
--set NAME says which cases (own): few, own, outside, pairs, nulls, unknown, strangers, local;
--cases N takes that many of them by chance; --seed N makes other cases (1); --reserved takes
those unknown kinds that nothing may be tuned on; --noise cameras has places as two cameras make
them out, with covariances, cameras-untold the same places without these; --tool PATH names another gst-cloth-gap-1.0
than the shell's, --programs DIR where the benchmark's own simulators are (beside the tool's
folder: ../tests/gapbench); --jobs N runs at a time (one a core).

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import argparse
import concurrent.futures
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

import numpy

import cases
import families
import reality
import score
import seal


def read_json(path):
    with open(path, encoding='utf-8') as file:
        return json.load(file)


def effect_table(tool):
    done = subprocess.run([tool, 'effects', '--format', 'json'], capture_output=True, check=True)
    return {effect['id']: effect for effect in json.loads(done.stdout)['effects']}


def in_parallel(function, arguments, jobs):
    """What a function returns for each tuple of arguments, some runs at a time."""
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(lambda given: function(*given), arguments)


def generate(realities, folder, chosen, count, seed, reserved=False, jobs=1, noise='even'):
    """Takes and commitments to folder/takes, labels to folder/sealed; all or nothing."""
    if os.path.exists(os.path.join(folder, 'sealed')):
        return
    random = numpy.random.default_rng(seed)
    listed = cases.list_set(chosen, effect_table(realities.tool), random, reserved)
    # The number of a case says nothing about it. Twins in jitter stay together.
    order = random.permutation(len(listed))
    if count < len(listed):
        order = order[:count]
        drawn = {listed[k]['draw'] for k in order}
        order = [k for k in random.permutation(len(listed)) if listed[k]['draw'] in drawn]
    takes = os.path.join(folder, 'takes')
    shutil.rmtree(takes, ignore_errors=True)
    os.makedirs(takes)

    def make(number, case):
        name = 'case%03d' % number
        path = os.path.join(takes, name)
        try:
            extra = reality.record(realities, case, path, name, seed, noise=noise)
        except families.CannotSimulate as error:
            print('%s left out, it can\'t be recorded: %s' % (name, error))
            shutil.rmtree(path, ignore_errors=True)
            return None
        return seal.seal(dict(case, case=name, **extra), path)

    made = in_parallel(make, ((number, listed[k]) for number, k in enumerate(order, 1)), jobs)
    labels = {label['case']: label for label in made if label}
    with open(os.path.join(takes, 'model.json'), 'w', encoding='utf-8') as file:
        json.dump(reality.diagnosed_model(), file, indent=1)
    seal.write_labels(os.path.join(folder, 'sealed'), labels)
    print('%d cases in %s, their labels in %s' % (len(labels), takes,
                                                  os.path.join(folder, 'sealed')))


def knows_twins(tool):
    done = subprocess.run([tool, 'diagnose', '--help'], capture_output=True, text=True,
                          check=False)
    return '--simulated' in done.stdout


def diagnose(tool, takes, gaps, jobs=1):
    """Diagnoses every case in @takes that has no gap.json in @gaps; returns how many failed."""
    names = sorted(name for name in os.listdir(takes) if os.path.isdir(os.path.join(takes, name)))
    left = [name for name in names if not os.path.exists(os.path.join(gaps, name, 'gap.json'))]
    # The first design has only baselines to hold a simulation against.
    twins = '--simulated' if left and knows_twins(tool) else '--baseline'

    def run(name):
        output = os.path.join(gaps, name)
        given = []
        for option, beside in (('--baseline', 'baseline'), (twins, 'simulated')):
            if os.path.isdir(os.path.join(takes, name, beside)):
                given += [option, os.path.join(takes, name, beside)]
        done = subprocess.run(
            [tool, 'diagnose', os.path.join(takes, name, 'take'), '--model',
             os.path.join(takes, 'model.json'), *given, '--seed', '1', '--threads', '1',
             '--output', output],
            capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)
        if done.returncode:
            return '%s: %s' % (name, done.stderr.strip().split('\n')[-1])
        # Hundreds of pages of the same kind; gap.json says the same.
        os.remove(os.path.join(output, 'report.html'))
        return None

    failed = 0
    begin = time.monotonic()
    for count, fault in enumerate(in_parallel(run, ((name,) for name in left), jobs), 1):
        if fault:
            print(fault)
            failed += 1
        if count in (3, 10) or count % 25 == 0:
            print('%d of %d diagnosed, about %.0f s to go' % (
                count, len(left), (time.monotonic() - begin) / count * (len(left) - count)),
                flush=True)
    return failed


def measure_oracle(tool, folder, name, label):
    """The gap with the effect that acted, as large as it was, in the model as it was fitted:
    its mean square in metres squared; None when it can't be simulated."""
    path = os.path.join(folder, 'oracle', name, 'gap.json')
    fitted = os.path.join(folder, 'gaps', name, 'fitted.json')
    if not os.path.exists(fitted):
        return None
    if not os.path.exists(path) or os.path.getmtime(path) < os.path.getmtime(fitted):
        model = read_json(fitted)
        model['effects'], model['free'] = reality.effects_in_take(label['effects']), []
        with tempfile.TemporaryDirectory(prefix='cloth-gapbench-') as scratch:
            file_name = os.path.join(scratch, 'model.json')
            with open(file_name, 'w', encoding='utf-8') as file:
                json.dump(model, file)
            # one effect, as one must be tested
            done = subprocess.run(
                [tool, 'diagnose', os.path.join(folder, 'takes', name, 'take'), '--model',
                 file_name, '--effects', 'gravity_scale', '--threads', '1', '--seed', '1',
                 '--output', os.path.dirname(path)],
                capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)
            if done.returncode:
                print('%s with the true effect: %s' % (name, done.stderr.strip().split('\n')[-1]))
                return None
    gap = read_json(path)['gap_before']['value']
    return None if gap is None else gap ** 2


def open_and_score(tool, folders, jobs=1):
    every, gaps, oracles, left = {}, {}, {}, []
    for folder in folders:
        labels = seal.open_labels(os.path.join(folder, 'sealed'), os.path.join(folder, 'takes'))
        before = os.path.normpath(folder) + '/' if len(folders) > 1 else ''
        here = {}
        for name in sorted(labels):
            path = os.path.join(folder, 'gaps', name, 'gap.json')
            every[before + name] = dict(labels[name], case=before + name, folder=folder)
            if os.path.exists(path):
                here[name] = read_json(path)
            else:
                left.append(before + name)
        named = [name for name in here if score.is_right(here[name], labels[name]) and
                 labels[name]['evidence'] in ('same', 'other')]
        measured = in_parallel(measure_oracle,
                               ((tool, folder, name, labels[name]) for name in named), jobs)
        oracles.update({before + name: square for name, square in zip(named, measured)})
        gaps.update({before + name: gap for name, gap in here.items()})
    text = score.report(every, gaps, left, effect_table(tool), oracles)
    if len(folders) == 1:
        with open(os.path.join(folders[0], 'score.md'), 'w', encoding='utf-8') as file:
            file.write(text)
        score.write_cases(os.path.join(folders[0], 'cases.txt'), every, gaps)
    print(text, end='')


def main():
    parser = argparse.ArgumentParser(description='The blind benchmark of the diagnosis.')
    parser.add_argument('step', choices=('generate', 'diagnose', 'score', 'all'))
    parser.add_argument('folder', nargs='+')
    parser.add_argument('--set', choices=('few',) + cases.SETS, default='own', dest='chosen')
    parser.add_argument('--cases', type=int, default=1000)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--noise', choices=reality.NOISES, default='even')
    parser.add_argument('--reserved', action='store_true')
    parser.add_argument('--tool', default='gst-cloth-gap-1.0')
    parser.add_argument('--programs')
    parser.add_argument('--jobs', type=int, default=os.cpu_count())
    given = parser.parse_args()
    folder, failed = given.folder[0], 0
    if len(given.folder) > 1 and given.step != 'score':
        parser.error('only score takes several folders')
    if given.reserved and given.chosen != 'unknown':
        parser.error('only the set unknown has reserved kinds')
    programs = given.programs or os.path.join(os.path.dirname(shutil.which(given.tool) or ''),
                                              '../tests/gapbench')
    os.makedirs(folder, exist_ok=True)
    try:
        if given.step in ('generate', 'all'):
            generate(families.Realities(given.tool, programs), folder, given.chosen, given.cases,
                     given.seed, given.reserved, given.jobs, given.noise)
        if given.step in ('diagnose', 'all'):
            failed = diagnose(given.tool, os.path.join(folder, 'takes'),
                              os.path.join(folder, 'gaps'), given.jobs)
        if given.step in ('score', 'all'):
            open_and_score(given.tool, given.folder, given.jobs)
    except (OSError, RuntimeError, seal.BrokenSeal) as error:
        sys.exit('gapbench: %s' % error)
    sys.exit(1 if failed else 0)


if __name__ == '__main__':
    main()
