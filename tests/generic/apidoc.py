#!/usr/bin/python3
"""Makes the pages of libgstcloth by gi-docgen, and reads them.

  apidoc.py GI-DOCGEN GIR CONFIG VERSION

Everything that is public has a page and words of its own, and no link between pages is dead.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import html
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

tool, gir, config, version = sys.argv[1:]
CORE = '{http://www.gtk.org/introspection/core/1.0}'
IDENTIFIER = '{http://www.gtk.org/introspection/c/1.0}identifier'
FUNCTIONS = {'function': 'func', 'method': 'method', 'constructor': 'ctor'}
faults = []


def expect(true, what):
    if not true:
        faults.append(what)


def words_of(node):
    return any(node.find(CORE + path) is not None for path in ('doc', 'return-value/' + CORE + 'doc'))


with open(config, encoding='utf-8') as file:
    expect('version = "%s"' % '.'.join(version.split('.')[:2]) in file.read(),
           'the version in %s is not %s' % (os.path.basename(config), version))
namespace = xml.etree.ElementTree.parse(gir).getroot().find(CORE + 'namespace')
pages = {}
for owner in [namespace] + list(namespace):
    for kind, page in FUNCTIONS.items():
        for node in owner.findall(CORE + kind):
            if node.get('introspectable') == '0' or node.get('moved-to'):
                continue
            expect(words_of(node), node.get(IDENTIFIER) + '() says nothing')
            path = [owner.get('name')] if owner is not namespace else []
            if kind == 'function' and path:
                page = 'type_func'
            pages[node.get(IDENTIFIER)] = '.'.join([page] + path + [node.get('name'), 'html'])
            page = FUNCTIONS[kind]
for kind in 'record', 'enumeration', 'constant':
    for node in namespace.findall(CORE + kind):
        expect(node.find(CORE + 'doc') is not None or node.get('disguised') == '1',
               node.get('name') + ' says nothing')

with tempfile.TemporaryDirectory(prefix='cloth-api-') as folder:
    done = subprocess.run([tool, 'generate', '--quiet', '--fatal-warnings', '--no-namespace-dir',
                           '--config', config, '--output-dir', folder, gir],
                          capture_output=True, text=True, timeout=120, check=False)
    expect(done.returncode == 0, 'gi-docgen: ' + done.stdout + done.stderr)
    texts = {}
    for name in os.listdir(folder):
        if name.endswith('.html'):
            with open(os.path.join(folder, name), encoding='utf-8') as file:
                texts[name] = file.read()
    for name, page in pages.items():
        expect(page in texts, '%s () has no page %s' % (name, page))
    links = 0
    for name, text in texts.items():
        for link in re.findall(r'(?:href|src)="([^"#:]+)(?:#[^"]*)?"', text):
            links += 1
            # gi-docgen 2023.1 takes a constructor that stands for another for a function.
            if link.startswith('type_func.') and link.replace('type_func', 'ctor', 1) in texts:
                continue
            expect(os.path.exists(os.path.join(folder, html.unescape(link))),
                   '%s: dead link %s' % (name, link))
    points = texts.get('method.Mesh.get_points.html', '')
    expect('Nothing is copied' in points and re.search(r'since:\s*0\.2', points, re.S),
           'the page of gst_cloth_mesh_get_points()')
    expect(len(pages) > 100 and links > 1000, 'only %d functions, %d links' % (len(pages), links))
for fault in faults[:30]:
    print('FAULT: ' + fault)
print('%d functions, %d pages, %d links, %d faults' % (len(pages), len(texts), links, len(faults)))
sys.exit(1 if faults else 0)
