#!/usr/bin/python3
"""Every command line program: --help, --version, exit codes, manual page.

  tools.py BUILD/tools ROOT/docs/man VERSION

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import glob
import os
import re
import subprocess
import sys


def run(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          stdin=subprocess.DEVNULL, timeout=60)


build, source, version = sys.argv[1:]
faults = []


def check(condition, text):
    if not condition:
        faults.append(text)


tools = sorted(p for p in glob.glob(os.path.join(build, 'gst-cloth-*-1.0')) if os.path.isfile(p))
check(tools, 'no tools in ' + build)
for tool in tools:
    name = os.path.basename(tool)
    done = run(tool, '--help')
    check(done.returncode == 0 and 'Usage:' in done.stdout, name + ' --help')
    options = sorted(set(re.findall(r'(?<![\w-])--[a-z][a-z-]+', done.stdout)))
    # each command has a help of its own, with an example that it takes
    commands = re.search(r'^Commands:\n((?:  .*\n)+)', done.stdout, re.M)
    for command in [row.split()[0] for row in commands.group(1).splitlines()] if commands else []:
        for asked in ([command, '--help'], ['-h', command, 'x']):
            told = run(tool, *asked)
            check(told.returncode == 0 and 'Usage:\n  %s [OPTION…] %s' % (name, command)
                  in told.stdout, '%s %s' % (name, ' '.join(asked)))
        example = told.stdout.partition('Example:\n')[2]
        check('%s %s' % (name, command) in example, '%s %s: no example' % (name, command))
        its = set(re.findall(r'(?<![\w-])--[a-z][a-z-]+', told.stdout.partition('Example:')[0]))
        check(its <= set(options) | {'--help'}, '%s %s: %s' % (name, command, its - set(options)))
        used = set(re.findall(r'(?<![\w-])--[a-z][a-z-]+', example))
        check(used <= its, '%s %s: the example has %s' % (name, command, used - its))
        check(not re.search(r'^ +(-\w, )?--\S+ +[a-z, -]+: ', told.stdout, re.M),
              '%s %s: a description names commands' % (name, command))
    done = run(tool, '--version')
    check(done.returncode == 0 and version in done.stdout, name + ' --version')
    for wrong in (['--no-such-option'], []):
        done = run(tool, *wrong)
        check(done.returncode == 2, '%s %s: exit code %d instead of 2'
              % (name, ' '.join(wrong), done.returncode))
        check(done.stderr.strip() and '--help' in done.stderr,
              '%s %s: stderr does not name --help' % (name, ' '.join(wrong)))
    manual = os.path.join(source, name + '.1')
    if not os.path.exists(manual):
        faults.append('%s: no manual page %s.1' % (name, name))
        continue
    with open(manual, encoding='utf-8') as file:
        text = file.read().replace('\\-', '-')
    for option in options:
        if not option.startswith('--help-'):
            check(option in text, '%s.1 says nothing of %s' % (name, option))
    for section in ('NAME', 'SYNOPSIS', 'DESCRIPTION', 'OPTIONS', 'EXIT STATUS'):
        check(re.search(r'^\.SH "?%s' % section, text, re.M), '%s.1: no %s' % (name, section))
    print('%s: %d options' % (name, len(options)))
for fault in faults:
    print(fault)
sys.exit(1 if faults else 0)
