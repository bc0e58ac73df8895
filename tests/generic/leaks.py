#!/usr/bin/python3
"""Runs a program under GStreamer's leaks tracer and fails when objects are left.

First the planted leak is run: were the tracer absent, everything would look clean.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import re
import subprocess
import sys


def alive(command):
    environment = dict(os.environ, GST_TRACERS='leaks', GST_DEBUG='GST_TRACER:7',
                       GST_DEBUG_NO_COLOR='1', G_SLICE='always-malloc')
    environment.pop('GST_DEBUG_FILE', None)
    # The tracer wants the main thread's gst_deinit: gst-launch-1.0 does it too.
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, errors='replace', timeout=280)
    found = re.findall(r'object-alive, type-name=\(string\)[^%\n].*', done.stderr)
    return done, found


def main():
    planted, command = sys.argv[1], sys.argv[2:]
    done, found = alive([planted])
    if done.returncode or not any('planted' in line for line in found):
        print('The leaks tracer does not see the planted leak: it is not alive.')
        print(done.stderr)
        return 1
    done, found = alive(command)
    if done.returncode:
        print(done.stdout[-4000:])
        print('\n'.join(line for line in done.stderr.split('\n')
                        if 'GST_TRACER' not in line)[-4000:])
        print('exit code %d' % done.returncode)
        return 1
    for line in found:
        print(line)
    print('%d objects left' % len(found))
    return 1 if found else 0


sys.exit(main())
