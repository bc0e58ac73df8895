#!/usr/bin/python3
"""Prints what became of films of coloured dots: of each camera and of the mesh.

  dots-summary.py TAKE

TAKE is a folder with states.npy, covariance.npy and observations/CAMERA.obs, as
dots-to-mesh.sh makes it.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import glob
import os
import struct
import sys

import numpy

NO_LABEL = 0xffffffff


def sections(path):
    """The dots' section of each picture; None where there is none."""
    with open(path, 'rb') as file:
        data = file.read()
    at = 0
    while at < len(data):
        magic, _, header, size, count = struct.unpack_from('<4sHHII', data, at)
        if magic != b'GCOB' or at + size > len(data):
            sys.exit('%s: byte %d begins no observation' % (path, at))
        inner, dots = at + header, None
        for _ in range(count):
            tag, length = struct.unpack_from('<4sI', data, inner)
            if tag == b'DOTS':
                dots = data[inner + 8:inner + 8 + length]
            inner += 8 + length
        yield dots
        at += size


def look(path):
    """Pictures, dots, labels and the variances of the labelled dots' places, px²."""
    n_pictures, n_dots, variances = 0, 0, []
    for dots in sections(path):
        n_pictures += 1
        if dots is None:
            continue
        n, name, colours = struct.unpack_from('<IHH', dots, 16)
        record = numpy.dtype([('label', '<u4', 2), ('flags', '<u4'), ('odds', '<f4'), ('place', '<f4', 2),
                              ('cov', '<f4', 3), ('colours', '<f4', colours)])
        table = numpy.frombuffer(dots, record, n, 24 + (name + 3) // 4 * 4)
        labelled = table[table['label'][:, 0] != NO_LABEL]
        n_dots += n
        variances.append((labelled['cov'][:, 0] + labelled['cov'][:, 2]) / 2)
    return n_pictures, n_dots, numpy.concatenate(variances) if variances else numpy.zeros(0)


def main():
    if len(sys.argv) != 2:
        sys.exit('usage: dots-summary.py TAKE')
    take = sys.argv[1]
    states = numpy.load(os.path.join(take, 'states.npy'))
    covariance = numpy.load(os.path.join(take, 'covariance.npy'))
    films = sorted(glob.glob(os.path.join(glob.escape(take), 'observations', '*.obs')))
    if not films:
        sys.exit('%s: no observations/CAMERA.obs in it' % take)
    print('camera      pictures  dots a picture  labelled   σ of a dot')
    for path in films:
        n_pictures, n_dots, variances = look(path)
        print('%-12s%8d%16.1f%9.1f%%%13s' % (
            os.path.basename(path)[:-4], n_pictures, n_dots / max(n_pictures, 1),
            100 * len(variances) / max(n_dots, 1),
            '%.3f px' % numpy.sqrt(variances.mean()) if len(variances) else '–'))
    spread = numpy.sqrt(covariance[..., [0, 3, 5]].sum(axis=-1))
    print('\nvertices        share   σ (median)')
    for state, words in ((1, 'three views'), (2, 'two views'), (3, 'filled'), (0, 'unseen')):
        here = states == state
        known = spread[here & numpy.isfinite(spread)]
        print('%-12s%8.1f%%%13s' % (words, 100 * here.mean(),
                                    '%.2f mm' % (1000 * numpy.median(known)) if len(known) else '–'))


main()
