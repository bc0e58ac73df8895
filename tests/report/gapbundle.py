#!/usr/bin/python3
"""The scripts and styles of the pages are what gst/gap/report/web makes of its sources.

  gapbundle.py check WEB          by the hashes in them: no network, no npm
  gapbundle.py rebuild WEB NPM    by making them anew, from the registry

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import filecmp
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

MADE = ('report.js', 'report.css', 'calibration.js', 'calibration.css', 'view.js', 'view.css')
HEAD = re.compile(rb'/\*! Made by [^\n]*\nsources sha256 ([0-9a-f]{64})\nbelow sha256 ([0-9a-f]{64})\n.*?\*/\n', re.S)


def sources_hash(web):
    names = ['build.mjs', 'package.json', 'package-lock.json']
    names += ['src/' + name for name in sorted(os.listdir(os.path.join(web, 'src')))]
    result = hashlib.sha256()
    for name in names:
        with open(os.path.join(web, name), 'rb') as file:
            text = file.read()
        result.update(b'%s %d\n' % (name.encode(), len(text)))
        result.update(text)
    return result.hexdigest()


def faults_of(web):
    faults = []
    with open(os.path.join(web, 'package.json'), encoding='utf-8') as file:
        package = json.load(file)
    with open(os.path.join(web, 'package-lock.json'), encoding='utf-8') as file:
        lock = json.load(file)['packages']
    wanted = {**package['dependencies'], **package['devDependencies']}
    for name, version in wanted.items():
        if not re.fullmatch(r'\d+\.\d+\.\d+', version):
            faults.append('%s: %s is no exact version' % (name, version))
        if lock.get('node_modules/' + name, {}).get('version') != version:
            faults.append('%s: the lock has another version' % name)
    for name, entry in lock.items():
        if name and not entry.get('integrity', '').startswith('sha512-'):
            faults.append('%s: the lock has no hash of it' % name)
    for made in MADE:
        with open(os.path.join(web, made), 'rb') as file:
            text = file.read()
        head = HEAD.match(text)
        if not head:
            faults.append('%s: no header' % made)
            continue
        if head[1].decode() != sources_hash(web):
            faults.append('%s: the sources have changed, run npm ci && npm run build in gst/gap/report/web' % made)
        if head[2].decode() != hashlib.sha256(text[head.end():]).hexdigest():
            faults.append('%s: edited by hand' % made)
        for name, version in package['dependencies'].items():
            if ('%s %s\n\nThe MIT License' % (name, version)).encode() not in head[0]:
                faults.append('%s: lacks the licence of %s %s' % (made, name, version))
    return faults


def spoil(folder, name, old, new):
    path = os.path.join(folder, name)
    with open(path, 'rb') as file:
        text = file.read()
    assert old in text, (name, old)
    with open(path, 'wb') as file:
        file.write(text.replace(old, new, 1))


def check(web):
    faults = faults_of(web)
    # Each rule catches what breaks it.
    for name, old, new, expected in (
            ('src/main.js', b'page', b'leaf', 'the sources have changed'),
            ('package-lock.json', b'sha512-', b'sha256-', 'the lock has no hash'),
            ('package.json', b'"three": "', b'"three": "^', 'no exact version'),
            ('report.js', b'recorded', b'recorder', 'edited by hand'),
            ('report.css', b'\nuplot ', b'\nuplus ', 'lacks the licence of uplot'),
            ('view.js', b'weft', b'woof', 'edited by hand'),
            ('report.css', b'Made by', b'Made in', 'no header')):
        with tempfile.TemporaryDirectory() as folder:
            copy = os.path.join(folder, 'web')
            shutil.copytree(web, copy, ignore=shutil.ignore_patterns('node_modules'))
            spoil(copy, name, old, new)
            if not any(expected in fault for fault in faults_of(copy)):
                faults.append('a spoilt %s is not noticed' % name)
    return faults


def rebuild(web, npm):
    with tempfile.TemporaryDirectory() as folder:
        copy = os.path.join(folder, 'web')
        shutil.copytree(web, copy, ignore=shutil.ignore_patterns('node_modules'))
        for made in MADE:
            os.unlink(os.path.join(copy, made))
        for command in (['ci', '--ignore-scripts', '--no-audit', '--no-fund'], ['run', 'build']):
            subprocess.run([npm] + command, cwd=copy, check=True)
        return ['%s: differs from a fresh build' % made for made in MADE
                if not filecmp.cmp(os.path.join(web, made), os.path.join(copy, made), shallow=False)]


found = check(sys.argv[2]) if sys.argv[1] == 'check' else rebuild(*sys.argv[2:4])
for fault in found:
    print(fault)
sys.exit(1 if found else 0)
