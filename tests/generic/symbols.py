#!/usr/bin/python3
"""What the libraries export and what they are linked with.

  symbols.py exports LIBRARY PREFIX...   every exported symbol starts with a prefix
  symbols.py links FILE...               only allowed libraries are linked

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import re
import subprocess
import sys

# Libraries under the GPL, or that pull them in: linking one changes our licence.
GPL = ('gsl', 'cholmod', 'umfpack', 'spqr', 'ceres', 'fftw3', 'CGAL', 'readline',
       'x264', 'x265', 'xvidcore', 'postproc', 'poppler', 'glpk')
# The rest of OpenCV brings in hundreds of libraries, GPL ones among them.
OPENCV = ('core', 'imgproc', 'features2d', 'flann', 'calib3d', 'video')


def run(*command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def exports(library, prefixes):
    names = [line.split()[-1] for line in run('nm', '-D', '--defined-only', library).splitlines()]
    alien = [name for name in names if not name.startswith(tuple(prefixes))]
    print('%d symbols exported by %s' % (len(names), library))
    for name in alien:
        print('not ours: ' + name)
    return bool(alien) or not names


def links(files):
    bad = []
    for file in files:
        direct = re.findall(r'\(NEEDED\).*\[(.*?)\]', run('readelf', '-d', file))
        every = re.findall(r'^\s*(\S+)', run('ldd', file), re.M)
        if not direct:
            bad.append('%s: readelf shows no library at all' % file)
        for name in direct:
            part = re.match(r'libopencv_(\w+)\.so', name)
            if part and part.group(1) not in OPENCV:
                bad.append('%s links %s' % (file, name))
        for name in every:
            stem = re.match(r'(?:.*/)?lib([A-Za-z0-9_+]+)', name)
            if stem and stem.group(1) in GPL:
                bad.append('%s pulls in %s' % (file, name))
        print('%s: %d libraries linked, %d in all' % (file, len(direct), len(every)))
    for line in bad:
        print(line)
    return bool(bad)


if sys.argv[1] == 'exports':
    sys.exit(exports(sys.argv[2], sys.argv[3:]))
sys.exit(links(sys.argv[2:]))
