#!/usr/bin/python3
"""Runs what the documents and the scripts in pipelines/ tell people to type.

  commands.py document FILE.md ROOT BUILD    every sh and python block, in order, one shell
  commands.py reached ROOT FILE.md...        every file in pipelines/ is run by one of them,
                                             every page is among those run, every link of
                                             a page leads somewhere

They run in a new folder that holds links to the repository's folders, so that what
they write goes nowhere else. A command that is shown but stands in no block that is
run is a fault too.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import re
import subprocess
import sys
import tempfile

FENCE = re.compile(r'^```([^\n]*)\n(.*?)^```\s*$', re.M | re.S)
# What is shown, not run: no line of it may look like one of our commands.
SHOWN = ('c', 'json', 'text', 'meson')
COMMAND = re.compile(r'^\s*\$?\s*(gst-launch-1\.0|gst-inspect-1\.0|gst-cloth-[a-z]+-1\.0|meson|ninja|'
                     r'\./|\. pipelines|CC=)', re.M)
# The same in the midst of a sentence; a name alone is no command.
INLINE = re.compile(r'`((?:gst-launch-1\.0|gst-inspect-1\.0|gst-cloth-[a-z]+-1\.0|meson|ninja|\./)'
                    r'[^`]* [^`]*)`')
LINK = re.compile(r'\]\(([^)\s]+)\)')
# For those who work on the source; what they tell to run is tests/run.sh and its parts.
FOR_DEVELOPERS = ('CONTRIBUTING.md', 'SECURITY.md', 'docs/adding-an-effect.md')
# The command that runs this very test.
OURSELVES = './tests/run.sh'


def environment(root, build):
    variables = dict(os.environ)
    variables.update({
        'CLOTH_BUILD': build,
        'CLOTH_TEST': '1',
        'LC_ALL': 'C.UTF-8',
        'GST_REGISTRY_1_0': os.path.join(build, 'tests/registry-commands.bin'),
        'GST_REGISTRY_FORK': 'no',
        'PATH': '/usr/bin:/bin:/usr/sbin:/sbin',
    })
    # What the document sets up must be enough, so none of this comes from outside.
    for name in ('GST_PLUGIN_PATH_1_0', 'GST_PLUGIN_PATH', 'GI_TYPELIB_PATH', 'MALLOC_PERTURB_',
                 'LD_LIBRARY_PATH', 'DISPLAY', 'WAYLAND_DISPLAY', 'GST_DEBUG', 'GST_TRACERS'):
        variables.pop(name, None)
    return variables


def lay_links(root, folder):
    for name in os.listdir(root):
        if not name.startswith(('.', 'build', 'cloth-quickstart')):
            os.symlink(os.path.join(root, name), os.path.join(folder, name))


def run(script, root, build):
    with tempfile.TemporaryDirectory(prefix='cloth-commands-') as folder:
        lay_links(root, folder)
        done = subprocess.run(['bash', '-e', '-o', 'pipefail', '-c', script],
                              cwd=folder, env=environment(root, build),
                              stdin=subprocess.DEVNULL, timeout=1170)
        left = [os.path.join(at, name) for at, _, names in os.walk(folder) for name in names]
        # A lock of meson's has nothing in it.
        empty = [name for name in left if not os.path.islink(name) and not os.path.getsize(name)
                 and os.path.basename(name) != 'meson.lock']
        for name in empty:
            print('left empty: ' + os.path.relpath(name, folder))
        return 1 if done.returncode or empty else 0


def document(path, root, build):
    with open(path, encoding='utf-8') as file:
        text = file.read()
    script = ''
    faults = []
    for match in FENCE.finditer(text):
        kind, block = match.group(1).strip(), match.group(2)
        line = text.count('\n', 0, match.start()) + 1
        if kind == 'sh':
            block = '\n'.join(row for row in block.split('\n') if row.strip() != OURSELVES)
            script += "echo '--- %s:%d' >&2\n%s\n" % (os.path.basename(path), line, block)
        elif kind == 'python':
            script += "echo '--- %s:%d' >&2\n/usr/bin/python3 - <<'END_OF_BLOCK'\n%sEND_OF_BLOCK\n" \
                % (os.path.basename(path), line, block)
        elif kind not in SHOWN:
            faults.append('line %d: a block marked "%s" is neither run nor known' % (line, kind))
        elif COMMAND.search(block):
            faults.append('line %d: shows a command that no test runs' % line)
    rest = FENCE.sub('', text)
    if COMMAND.search(rest):
        faults.append('a command outside any block: ' + COMMAND.search(rest).group(0).strip())
    for match in INLINE.finditer(rest):
        faults.append('a command outside any block: ' + match.group(1))
    for fault in faults:
        print('%s: %s' % (path, fault))
    if not script:
        print('%s: no commands' % path)
        return 1 if faults else 0
    # The first set-up command of the README makes this available to a reader.
    if not re.search(r'^\. pipelines/environment\.sh', script, re.M):
        script = '. pipelines/environment.sh\n' + script
    return run(script, root, build) or (1 if faults else 0)


def pages_of(root):
    """All pages, as paths from the root."""
    return [os.path.normpath(os.path.join(folder, name))
            for folder in ('.', 'docs', 'pipelines') for name in os.listdir(os.path.join(root, folder))
            if name.endswith('.md')]


def anchors_of(text):
    """What headings are called in a link."""
    return {re.sub(r'[^\w\- ]', '', heading.lower()).replace(' ', '-')
            for heading in re.findall(r'^#+ (.*?)\s*$', text, re.M)}


def dead_links(root):
    faults = 0
    for page in pages_of(root):
        with open(os.path.join(root, page), encoding='utf-8') as file:
            text = FENCE.sub('', file.read())
        for link in LINK.findall(text):
            if re.match(r'[a-z]+:', link):
                continue
            name, _, anchor = link.partition('#')
            target = os.path.join(root, os.path.dirname(page), name) if name \
                else os.path.join(root, page)
            good = os.path.exists(target)
            if good and anchor:
                with open(target, encoding='utf-8') as file:
                    good = anchor in anchors_of(file.read())
            if not good:
                print('%s: the link to %s leads nowhere' % (page, link))
                faults += 1
    return faults


def reached(root, run_pages):
    """A script is run by a block of a document, or by a script that is."""
    faults = dead_links(root)
    for page in pages_of(root):
        if page not in run_pages and page not in FOR_DEVELOPERS:
            print('%s is a page whose commands no test runs' % page)
            faults += 1
    text = ''
    for folder in ('.', 'docs'):
        for name in os.listdir(os.path.join(root, folder)):
            if name.endswith('.md'):
                with open(os.path.join(root, folder, name), encoding='utf-8') as file:
                    text += ''.join(block for kind, block in FENCE.findall(file.read())
                                    if kind.strip() == 'sh')
    top = os.path.join(root, 'pipelines')
    waiting = {os.path.relpath(os.path.join(folder, name), top)
               for folder, _, names in os.walk(top) for name in names
               if name != 'README.md' and not folder.endswith('__pycache__')}
    print('%d files in pipelines/' % len(waiting))
    while True:
        now = {name for name in waiting if 'pipelines/' + name in text}
        if not now:
            break
        waiting -= now
        for name in now:
            with open(os.path.join(root, 'pipelines', name), encoding='utf-8') as file:
                text += file.read()
    for name in sorted(waiting):
        print('pipelines/%s is run by no document' % name)
    return 1 if waiting or faults else 0


if sys.argv[1] == 'reached':
    sys.exit(reached(sys.argv[2], sys.argv[3:]))
sys.exit(document(sys.argv[2], os.path.abspath(sys.argv[3]), os.path.abspath(sys.argv[4])))
