#!/usr/bin/python3
"""Completes command lines as bash does, by tools/completion/gst-cloth.

  completion.py SCRIPT BUILD/tools

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import subprocess
import sys
import tempfile

script, tools = (os.path.abspath(path) for path in sys.argv[1:])
faults = []


def complete(*words, folder='.'):
    """What the last word may become."""
    done = subprocess.run(
        ['bash', '--norc', '-c', '. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
         '_gst_cloth "$1" "${!#}" "${COMP_WORDS[COMP_CWORD-1]}"; printf "%s\\n" "${COMPREPLY[@]}"',
         script] + list(words), capture_output=True, text=True, cwd=folder, timeout=60,
        env=dict(os.environ, PATH=tools + ':/usr/bin:/bin', LC_ALL='C.UTF-8'))
    if done.returncode or done.stderr:
        faults.append('%s: %s' % (words, done.stderr))
    return [line for line in done.stdout.split('\n') if line]


def expect(words, has=(), lacks=(), only=None, **more):
    got = complete(*words, **more)
    for word in has:
        if word not in got:
            faults.append('%s: no %s in %s' % (words, word, got))
    for word in lacks:
        if word in got:
            faults.append('%s: %s in %s' % (words, word, got))
    if only is not None and sorted(got) != sorted(only):
        faults.append('%s: %s instead of %s' % (words, got, only))


take, gap, fit = 'gst-cloth-take-1.0', 'gst-cloth-gap-1.0', 'gst-cloth-fit-1.0'
expect([take, ''], only=['import', 'info', 'recover'])
expect([take, 'i'], only=['import', 'info'])
expect([take, 'x'], only=[])
expect([take, 'import', '--'], has=['--clamp', '--clamp-file', '--units', '--overwrite', '--help'],
       lacks=['--version', '--effects'])
expect([take, 'import', '--clamp'], only=['--clamp', '--clamp-file'])
expect([take, 'recover', '--'], has=['--overwrite'], lacks=['--units', '--clamp'])
expect([take, 'import', 'a.csv', '--units', ''], only=['m', 'cm', 'mm', 'in'])
expect([take, 'import', 'a.csv', '-a', 'y'], only=['y-up'])
expect([gap, ''], only=['diagnose', 'compare', 'survey', 'simulate', 'check-simulator', 'effects'])
expect([gap, 'survey', '--'], has=['--spool', '--workers', '--worker', '--resume', '--model'], lacks=['--baseline'])
expect([gap, 'simulate', '--'], has=['--scene', '--output', '--seed'], lacks=['--baseline'])
expect([fit, 'fit', '--'], has=['--model', '--rig'], lacks=['--spool', '--tracker'])
expect([fit, 'search', '--'], has=['--model', '--spool', '--evaluations'], lacks=['--tracker'])
expect([fit, 'track', '--'], has=['--rig', '--tracker', '--held', '--seed'], lacks=['--model', '--spool'])
expect([gap, 'diagnose', 'a.take', '--effects', 'air'], has=['air_drag'], lacks=['wind'])
expect([gap, 'effects', '--format', ''], only=['text', 'json', 'markdown'])
expect(['gst-cloth-pattern-1.0', ''], only=['checker', 'coded-checker', 'm-array', 'picture', 'garment'])
expect(['gst-cloth-calibrate-1.0', 'u'], only=['upright'])
expect(['gst-cloth-calibrate-1.0', 'upright', '--'], has=['--world', '--pattern'], lacks=['--lens', '--warp'])
expect(['gst-cloth-pattern-1.0', 'c'], only=['checker', 'coded-checker'])
expect(['gst-cloth-pattern-1.0', 'checker', '--squ'], only=['--square'])
expect(['gst-cloth-calibrate-1.0', '--pat'], only=['--pattern'])
with tempfile.TemporaryDirectory() as folder:
    for name in 'robot a.csv', 'robot.take':
        with open(os.path.join(folder, name), 'w', encoding='ascii'):
            pass
    expect([take, 'import', 'rob'], only=['robot a.csv', 'robot.take'], folder=folder)
    expect([take, 'import', '--output', 'robot.'], only=['robot.take'], folder=folder)
    expect([take, 'import', 'none'], only=[], folder=folder)
# A program that is not there completes nothing, and says nothing.
expect(['gst-cloth-none-1.0', ''], only=[])
loads = subprocess.run(['bash', '--norc', '-c', '. "$0"; complete -p', script],
                       capture_output=True, text=True, timeout=60)
programs = [name for name in os.listdir(tools) if name.startswith('gst-cloth-')
            and os.path.isfile(os.path.join(tools, name))]
for name in programs:
    if name not in loads.stdout:
        faults.append('%s is not completed' % name)
for fault in faults:
    print('FAULT: ' + fault)
print('%d programs, %d faults' % (len(programs), len(faults)))
sys.exit(1 if faults or not programs else 0)
