#!/usr/bin/python3
"""Installs into a folder of its own and uses the result as somebody else would.

  install.py MESON BUILD C-PROGRAM WITH-INTROSPECTION

What must be there is there, the plugin loads, a C program builds with pkg-config alone and
runs, every installed header compiles by itself, and Python finds the typelib.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import glob
import os
import shlex
import subprocess
import sys
import tempfile

MESON, BUILD, PROGRAM, INTROSPECTION = sys.argv[1:5]


def run(command, **keywords):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, check=False, **keywords)
    if done.returncode:
        sys.exit('%s\n%s' % (' '.join(command), done.stdout))
    return done.stdout


def only(pattern):
    found = glob.glob(pattern, recursive=True)
    if len(found) != 1:
        sys.exit('%d files %s were installed instead of one' % (len(found), pattern))
    return found[0]


with tempfile.TemporaryDirectory() as dest:
    run(shlex.split(MESON) + ['install', '-C', BUILD, '--no-rebuild', '--destdir', dest])
    pc = only(dest + '/**/pkgconfig/gstreamer-cloth-1.0.pc')
    library = os.path.dirname(only(dest + '/**/libgstcloth-1.0.so'))
    plugin = only(dest + '/**/gstreamer-1.0/libgstcloth.so')
    headers = glob.glob(dest + '/**/include/gstreamer-1.0/gst/cloth/*.h', recursive=True)
    if len(headers) < 6 or any('private' in name for name in headers):
        sys.exit('installed headers: %s' % headers)

    env = dict(os.environ)
    env['LD_LIBRARY_PATH'] = library
    env.pop('GST_PLUGIN_PATH_1_0', None)
    # The same file with the prefix that the folder stands for.
    moved = os.path.join(dest, 'pkgconfig')
    os.mkdir(moved)
    with open(pc, encoding='utf-8') as file:
        text = file.read()
    with open(os.path.join(moved, os.path.basename(pc)), 'w', encoding='utf-8') as file:
        file.write(text.replace('prefix=', 'prefix=' + dest, 1))
    env['PKG_CONFIG_PATH'] = moved
    flags = run(['pkg-config', '--cflags', '--libs', 'gstreamer-cloth-1.0'], env=env).split()
    program = os.path.join(dest, 'program')
    compiler = shlex.split(os.environ.get('CC', 'cc'))
    run(compiler + ['-Wall', '-Wextra', '-Werror', PROGRAM, '-o', program] + flags, env=env)
    for name in ('calibrate', 'gap', 'pattern', 'take', 'view'):
        only(dest + '/**/bash-completion/completions/gst-cloth-%s-1.0' % name)
    if 'meshsrc' not in run(['gst-inspect-1.0', plugin], env=env):
        sys.exit('the installed plugin has no elements')
    said = run([program], env=env)
    if said != '12.25 7.5 63\n':
        sys.exit('the program said %r' % said)
    for header in headers:
        source = os.path.join(dest, 'header.c')
        with open(source, 'w', encoding='utf-8') as file:
            file.write('#include <gst/cloth/%s>\nint main (void) { return 0; }\n'
                       % os.path.basename(header))
        run(compiler + ['-Wall', '-Wextra', '-Werror', '-fsyntax-only', source] + flags,
            env=env)
    if INTROSPECTION == 'true':
        only(dest + '/**/gir-1.0/GstCloth-1.0.gir')
        env['GI_TYPELIB_PATH'] = os.path.dirname(
            only(dest + '/**/girepository-1.0/GstCloth-1.0.typelib'))
        said = run([sys.executable, '-c',
                    'import gi; gi.require_version("GstCloth", "1.0");'
                    'from gi.repository import GstCloth;'
                    'print(GstCloth.MAX_VERTICES)'], env=env)
        if said != '1000000\n':
            sys.exit('Python said %r' % said)
    print('%d headers, program, typelib: good' % len(headers))
