#!/usr/bin/python3
"""The table of docs/gap-benchmark.md of takes that two simulators made which this project did not
write: each diagnosed with what its own simulator makes without the effect, and with nothing.

  takes.py TOOL TAKES FOLDER [NAME…]

TAKES is shared/data/takes. A diagnosis (NAME: t14.twin, t14.none or t71.baseline; all of them) goes to
FOLDER and isn't made again when it is there. Each takes minutes; they run one after the other. The table
is of what is in FOLDER.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import subprocess
import sys

tool, takes, output, *only = sys.argv[1:]


def read_json(*path):
    with open(os.path.join(*path), encoding='utf-8') as file:
        return json.load(file)


def find_twin(name):
    """A take of the same simulator and motion without an effect, None where nobody made one."""
    for other, label in labels.items():
        if other != name and label['effect'] == 'none' and all(
                label[key] == labels[name][key] for key in ('simulator', 'scene')):
            return other
    return None


def diagnose(name, kind):
    folder = os.path.join(output, '%s.%s' % (name, kind))
    if os.path.exists(os.path.join(folder, 'gap.json')) or only and '%s.%s' % (name, kind) not in only:
        return
    given = {'twin': ['--simulated', find_twin(name)], 'baseline': ['--baseline', pairs[name]],
             'none': []}[kind]
    subprocess.run([tool, 'diagnose', os.path.join(takes, name), '--model',
                    os.path.join(takes, 'model.json'), '--output', folder] +
                   given[:1] + [os.path.join(takes, take) for take in given[1:]], check=True)


def millimetres(estimate):
    return '–' if estimate['value'] is None else '%.1f' % (1e3 * estimate['value'])


def print_row(name, kind):
    path = os.path.join(output, '%s.%s' % (name, kind))
    if not os.path.exists(os.path.join(path, 'gap.json')):
        return
    gap = read_json(path, 'gap.json')
    take = next(take for take in gap['takes'] if take['role'] == 'take')
    first = gap['effects'][0]
    print('| %s | %s, %s | %s | %s | %s | `%s` %.0f%% | %s | %s, %s (%s) | %s, %s (%s) |' % (
        name, labels[name]['simulator'].split()[0], labels[name]['scene'],
        labels[name]['described'].replace('|', '\\|'), kind, gap['verdict'], first['name'],
        100. * first['probability'],
        ', '.join('`%s`' % e['name'] for e in gap['effects'] if e['accepted']) or '–',
        *(millimetres(gap[key]) for key in ('gap_before', 'gap_after', 'noise_floor')),
        *(millimetres(take[key]) for key in ('free_before', 'free_after', 'free_floor'))))


labels, pairs = read_json(takes, 'labels.json'), read_json(takes, 'pairs.json')
# where nobody made a twin, the base take of another motion stands in
cases = [(name, kind) for name in sorted(labels) if not name.startswith('base_')
         for kind in ('twin' if find_twin(name) else 'baseline', 'none')]
for case in cases:
    diagnose(*case)
for case in cases:
    print_row(*case)
