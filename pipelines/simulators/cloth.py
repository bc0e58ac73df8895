#!/usr/bin/python3
"""The project's own simulator behind the contract of docs/own-simulator.md: the shortest
adapter there is, to be copied.

  gst-cloth-gap-1.0 check-simulator pipelines/simulators/cloth.py --scene TAKE

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import os
import subprocess
import sys

# name, unit, value, range, what it is in a model.json
PARAMETERS = [
    ('stretch', 'N/m', 100, [10, 2000], ['stretch.warp', 'stretch.weft']),
    ('shear', 'N/m', 40, [2, 500], 'shear'),
    ('bending', 'N m', 2e-5, [1e-6, 1e-3], ['bending.warp', 'bending.weft']),
    ('friction', '1/s', 0.2, [0, 10], 'damping.mass'),
    ('drag', '1', 0, [0, 10], 'effects.air_drag.coefficient'),
]


def main(argument):
    if argument == '--capabilities':
        json.dump({'version': 1, 'simulator': 'gst-cloth', 'parameters': [
            {'name': name, 'unit': unit, 'value': value, 'range': limits, 'is': what, 'scale': 1}
            for name, unit, value, limits, what in PARAMETERS]}, sys.stdout)
        return 0
    with open(os.path.join(argument, 'parameters.json'), encoding='utf-8') as file:
        p = json.load(file)
    model = {'version': 1, 'stretch': {'warp': p['stretch'], 'weft': p['stretch']},
             'shear': p['shear'], 'bending': {'warp': p['bending'], 'weft': p['bending']},
             'damping': {'mass': p['friction'], 'stiffness': 1e-3},
             'effects': {'air_drag': {'coefficient': p['drag']}}}
    with open(os.path.join(argument, 'model.json'), 'w', encoding='utf-8') as file:
        json.dump(model, file)
    return subprocess.run(
        ['gst-cloth-gap-1.0', 'simulate', file.name, '--scene', os.path.join(argument, 'scene'),
         '--output', os.path.join(argument, 'simulated')], check=False).returncode


sys.exit(main(sys.argv[1]))
