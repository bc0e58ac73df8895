#!/usr/bin/python3
"""Sources pipelines/environment.sh in the shells that there are.

  environment.py ROOT BUILD

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import shutil
import subprocess
import sys
import tempfile

root, build = map(os.path.abspath, sys.argv[1:])
script = os.path.join(root, 'pipelines/environment.sh')
clean = {name: value for name, value in os.environ.items() if name not in (
    'GST_PLUGIN_PATH_1_0', 'GI_TYPELIB_PATH', 'LD_LIBRARY_PATH', 'PKG_CONFIG_PATH', 'MANPATH')}
faults = []


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what))
    if not true:
        faults.append(what)


def run(shell, folder, command, **variables):
    done = subprocess.run([shell, '-c', command], cwd=folder, env=dict(clean, **variables),
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, check=False)
    return done.returncode, done.stdout, done.stderr


def good(shell, folder, path):
    command = '. %s && gst-cloth-pattern-1.0 --version && pkg-config --cflags gstreamer-cloth-1.0 && ' \
        'printf "%%s\\n" "$GST_PLUGIN_PATH_1_0" "$MANPATH" "$PKG_CONFIG_PATH"' % path
    code, text, error = run(shell, folder, command, CLOTH_BUILD=build, MANPATH='/usr/man')
    expect(code == 0 and not error, '%s in %s: %s' % (shell, folder, error))
    if code != 0:
        return
    version, flags, plugins, man, packages = text.splitlines()
    expect(version, version)
    expect('-I%s ' % root in flags + ' ', 'headers by pkg-config: ' + flags)
    expect(plugins == build + '/elements', plugins)
    expect(packages == build + '/meson-uninstalled', packages)
    pages, rest = man.split(':')
    expect(rest == '/usr/man' and os.path.isfile(pages + '/man1/gst-cloth-gap-1.0.1'), man)


def main():
    shells = [shell for shell in ('bash', 'dash', 'zsh') if shutil.which(shell)]
    with tempfile.TemporaryDirectory() as folder:
        for shell in shells:
            good(shell, root, 'pipelines/environment.sh')
            for where, path in ((root, 'pipelines/environment.sh'), (folder, script)):
                code, text, error = run(shell, where, '. %s; echo "code $? [${MANPATH:-}]"' % path, CLOTH_BUILD=folder)
                if shell == 'dash' and where == folder:
                    continue
                expect('there is no build in ' + folder in error and 'quickstart.sh' in error, error)
                expect(text == 'code 1 []\n', '%s goes on and nothing is set: %s' % (shell, text))
        good('bash', folder, script)
        if 'dash' in shells:
            code, text, error = run('dash', folder, '. %s; echo "code $? [${MANPATH:-}]"' % script, CLOTH_BUILD=build)
            expect("this shell doesn't tell where the file is" in error and text == 'code 1 []\n', error + text)
    return 1 if faults else 0


sys.exit(main())
