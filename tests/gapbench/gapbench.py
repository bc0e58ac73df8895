#!/usr/bin/python3
"""The blind benchmark of the diagnosis.

  gapbench.py generate DIR   writes DIR/takes, and what was done to them to DIR/sealed
  gapbench.py diagnose DIR   diagnoses DIR/takes, which is all it reads, to DIR/gaps
  gapbench.py score DIR...   opens the labels, measures the gaps with what was really done,
                             writes DIR/score.md and DIR/cases.txt; of several only prints
                             the figures of all cases together
  gapbench.py all DIR        all three

What is there already is not made again, so that a run that was stopped goes on.
--few takes a handful of easy cases, --local those whose place or time is known, --cases N
that many drawn by chance instead of all, none of the local ones;
--seed N makes other cases (1), --tool PATH names another gst-cloth-gap-1.0 than the
shell's.

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
import reality
import score
import seal


def read_json(path):
    with open(path, encoding='utf-8') as file:
        return json.load(file)


def effect_table(tool):
    done = subprocess.run([tool, 'effects', '--format', 'json'], capture_output=True, check=True)
    return {effect['id']: effect for effect in json.loads(done.stdout)['effects']}


def in_parallel(function, arguments):
    """What a function returns for each tuple of arguments, one run a core."""
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        yield from pool.map(lambda given: function(*given), arguments)


def generate(tool, folder, few, count, seed, only_local=False):
    """Takes and commitments to folder/takes, labels to folder/sealed; all or nothing."""
    if os.path.exists(os.path.join(folder, 'sealed')):
        return
    random = numpy.random.default_rng(seed)
    listed = (cases.list_few if few else cases.list_all)(effect_table(tool), random)
    # The number of a case says nothing about it, but that the last are local ones.
    numbers = [int(number) for number in random.permutation(len(listed)) + 1]
    if not few:
        local = cases.list_local(numpy.random.default_rng([seed, len(listed)]))
        numbers += range(len(listed) + 1, len(listed) + len(local) + 1)
        listed = local if only_local else listed + local
        numbers = numbers[-len(listed):]
    takes = os.path.join(folder, 'takes')
    shutil.rmtree(takes, ignore_errors=True)
    os.makedirs(takes)

    def make(number, case):
        name = 'case%03d' % number
        path = os.path.join(takes, name)
        with tempfile.TemporaryDirectory(prefix='cloth-gapbench-') as scratch:
            try:
                extra = reality.record(tool, case, path, name, scratch,
                                       numpy.random.default_rng([seed, number]))
            except RuntimeError as error:
                print('%s left out, it can\'t be recorded: %s' % (name, error))
                shutil.rmtree(path, ignore_errors=True)
                return None
        return seal.seal(dict(case, case=name, **extra), path)

    chosen = ((number, case) for number, case in zip(numbers, listed) if number <= count)
    labels = {label['case']: label for label in in_parallel(make, chosen) if label}
    with open(os.path.join(takes, 'model.json'), 'w', encoding='utf-8') as file:
        json.dump(reality.diagnosed_model(), file, indent=1)
    seal.write_labels(os.path.join(folder, 'sealed'), labels)
    print('%d cases in %s, their labels in %s' % (len(labels), takes,
                                                  os.path.join(folder, 'sealed')))


def diagnose(tool, takes, gaps):
    """Diagnoses every case in @takes that has no gap.json in @gaps; returns how many failed."""
    names = sorted(name for name in os.listdir(takes) if os.path.isdir(os.path.join(takes, name)))
    left = [name for name in names if not os.path.exists(os.path.join(gaps, name, 'gap.json'))]

    def run(name):
        output = os.path.join(gaps, name)
        done = subprocess.run(
            [tool, 'diagnose', os.path.join(takes, name, 'take'), '--model',
             os.path.join(takes, 'model.json'), '--baseline',
             os.path.join(takes, name, 'baseline'), '--seed', '1', '--threads', '1',
             '--output', output],
            capture_output=True, text=True, stdin=subprocess.DEVNULL, check=False)
        if done.returncode:
            return '%s: %s' % (name, done.stderr.strip().split('\n')[-1])
        # Hundreds of pages of the same kind; gap.json says the same.
        os.remove(os.path.join(output, 'report.html'))
        return None

    failed = 0
    begin = time.monotonic()
    for count, fault in enumerate(in_parallel(run, ((name,) for name in left)), 1):
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


def open_and_score(tool, folders):
    every, gaps, oracles, left = {}, {}, {}, []
    for folder in folders:
        labels = seal.open_labels(os.path.join(folder, 'sealed'), os.path.join(folder, 'takes'))
        before = os.path.normpath(folder) + '/' if len(folders) > 1 else ''
        here = {}
        for name in sorted(labels):
            path = os.path.join(folder, 'gaps', name, 'gap.json')
            every[before + name] = dict(labels[name], case=before + name)
            if os.path.exists(path):
                here[name] = read_json(path)
            else:
                left.append(before + name)
        named = [name for name in here if score.is_right(here[name], labels[name])]
        measured = in_parallel(measure_oracle,
                               ((tool, folder, name, labels[name]) for name in named))
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
    parser.add_argument('--few', action='store_true')
    parser.add_argument('--local', action='store_true')
    parser.add_argument('--cases', type=int, default=1000)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--tool', default='gst-cloth-gap-1.0')
    given = parser.parse_args()
    folder, failed = given.folder[0], 0
    if len(given.folder) > 1 and given.step != 'score':
        parser.error('only score takes several folders')
    os.makedirs(folder, exist_ok=True)
    try:
        if given.step in ('generate', 'all'):
            generate(given.tool, folder, given.few, given.cases, given.seed,
                     given.local)
        if given.step in ('diagnose', 'all'):
            failed = diagnose(given.tool, os.path.join(folder, 'takes'),
                              os.path.join(folder, 'gaps'))
        if given.step in ('score', 'all'):
            open_and_score(given.tool, given.folder)
    except (OSError, RuntimeError, seal.BrokenSeal) as error:
        sys.exit('gapbench: %s' % error)
    sys.exit(1 if failed else 0)


if __name__ == '__main__':
    main()
