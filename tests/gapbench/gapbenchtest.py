#!/usr/bin/python3
"""The blind benchmark itself, on a handful of cases: seals, blindness, scores.

  gapbenchtest.py TOOL PROGRAMS

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import contextlib
import glob
import io
import json
import os
import shutil
import sys
import tempfile

import numpy

import families
import gapbench
import reality
import score
import seal

tool = os.path.abspath(sys.argv[1])
faults = []


def expect(true, what):
    print('%s: %s' % ('ok' if true else 'FAULT', what))
    if not true:
        faults.append(what)


def write_json(path, content):
    with open(path, 'w', encoding='utf-8') as file:
        json.dump(content, file)


def intervals():
    # Textbook values of Clopper and Pearson's interval.
    for hits, count, low, high in ((0, 10, 0., 0.3085), (5, 10, 0.1871, 0.8129),
                                   (10, 10, 0.6915, 1.), (1, 20, 0.0013, 0.2487),
                                   (0, 59, 0., 0.0606), (0, 0, 0., 1.)):
        got = score.binomial_interval(hits, count)
        expect(abs(got[0] - low) < 1e-4 and abs(got[1] - high) < 1e-4,
               '%d of %d: %.4f to %.4f' % (hits, count, *got))


def spreads(folder):
    """Places by two cameras are off by what their covariances say, and the same without these."""
    makers = {noise: numpy.random.default_rng(1) for noise in ('cameras', 'cameras-untold')}
    for noise, random in makers.items():
        setup = reality.move(dict(reality.choose_setup({'stranger': None}, random), noise=noise), random)
        still = families.flat_points(setup, (setup['cloth']['columns'], setup['cloth']['rows']))
        reality.film(os.path.join(folder, noise), 'still', setup,
                     numpy.repeat(still[None], len(setup['paths']), axis=0), random)
    told, untold = (os.path.join(folder, noise) for noise in makers)
    y = numpy.load(os.path.join(told, 'positions.npy')).astype(float)
    expect(numpy.array_equal(y, numpy.load(os.path.join(untold, 'positions.npy')), equal_nan=True)
           and not os.path.exists(os.path.join(untold, 'covariance.npy')),
           'the same places with and without covariances')
    upper = numpy.load(os.path.join(told, 'covariance.npy')).astype(float)
    seen = ~numpy.isnan(y[..., 0])
    expect(numpy.array_equal(seen, ~numpy.isnan(upper[..., 0])), 'a covariance for each place seen')
    off = (y - still)[seen]
    spread = upper[seen][:, [0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(-1, 3, 3)
    square = (off * numpy.linalg.solve(spread, off[:, :, None])[:, :, 0]).sum(axis=1).mean() / 3.
    expect(abs(square - 1.) < 0.03, 'whitened by its covariance the noise is %.3f' % square)
    across = numpy.sqrt(numpy.linalg.eigvalsh(spread))
    expect((across[:, 2] > 3. * across[:, 0]).all(), 'three times as far off in depth as across')


def blind(takes, labels):
    """Nothing beside the takes tells what was done to them."""
    words = {'outside', 'severity', 'springs', 'mesh_resolution', 'fem', 'twin', 'evidence'}.union(
        *(label['effects'] for label in labels.values()))
    texts = ''
    for at, _, names in os.walk(takes):
        for name in names:
            if not name.endswith('.npy'):
                with open(os.path.join(at, name), encoding='utf-8') as file:
                    texts += file.read()
    expect(len(texts) > 1000 and not [word for word in words if word in texts],
           'no label lies open')


def refused(folder, what, change):
    """A change to what was sealed is found before anything is scored."""
    copy = folder + '-changed'
    shutil.copytree(folder, copy)
    with open(os.path.join(copy, 'sealed/labels.json'), encoding='utf-8') as file:
        sealed = json.load(file)
    change(sealed['labels'], os.path.join(copy, 'takes'))
    write_json(os.path.join(copy, 'sealed/labels.json'), sealed)
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            gapbench.open_and_score(tool, [copy])
        expect(False, what + ' is refused')
    except seal.BrokenSeal as error:
        expect(not os.path.exists(os.path.join(copy, 'score.md')), '%s: %s' % (what, error))
    shutil.rmtree(copy)


def refusals(folder):
    def soften(labels, takes):
        labels['case001']['severity'] += 1.

    def swap(labels, takes):
        a, b = labels['case001'], labels['case002']
        labels['case001'], labels['case002'] = dict(b, case='case001'), dict(a, case='case002')

    def move(labels, takes):
        labels['case001'], labels['case002'] = labels['case002'], labels['case001']

    def drop(labels, takes):
        del labels['case003']

    def reseal(labels, takes):
        # Whoever rewrites the commitment as well still has the wrong takes.
        shutil.rmtree(os.path.join(takes, 'case001/take'))
        shutil.copytree(os.path.join(takes, 'case002/take'), os.path.join(takes, 'case001/take'))

    def touch(labels, takes):
        beside = glob.glob(os.path.join(takes, 'case004/[bs]*/positions.npy'))[0]
        with open(beside, 'r+b') as file:
            file.seek(5000)
            byte = file.read(1)[0]
            file.seek(5000)
            file.write(bytes([byte ^ 1]))

    for what, change in (('a softened label', soften), ('two labels exchanged', swap),
                         ('two entries exchanged', move), ('a label left out', drop),
                         ('another take', reseal), ('a bit of a take', touch)):
        refused(folder, what, change)


def diagnoses(folder):
    takes, gaps = os.path.join(folder, 'takes'), os.path.join(folder, 'gaps')
    # What can't be found can't be read.
    away = folder + '-sealed'
    os.rename(os.path.join(folder, 'sealed'), away)
    expect(gapbench.diagnose(tool, takes, gaps) == 0, 'all diagnosed')
    os.rename(away, os.path.join(folder, 'sealed'))
    expect(gapbench.diagnose('/nowhere', takes, gaps) == 0, 'a second run finds all done')
    shutil.rmtree(os.path.join(gaps, 'case002'))
    expect(gapbench.diagnose('/bin/false', takes, gaps) == 1, 'and sees what is not')
    expect(gapbench.diagnose(tool, takes, gaps) == 0, 'which it makes up for')


def scores(folder, labels):
    gapbench.open_and_score(tool, [folder])
    with open(os.path.join(folder, 'score.md'), encoding='utf-8') as file:
        text = file.read()
    gaps = {name: gapbench.read_json(os.path.join(folder, 'gaps', name, 'gap.json'))
            for name in labels}
    for name, label in labels.items():
        gap = gaps[name]
        if label['kind'] == 'none':
            expect(gap['verdict'] == 'no_gap', '%s: no gap is called %s' % (name, gap['verdict']))
        else:
            expect(score.named_first(gap, label) and gap['verdict'] not in score.SILENT,
                   '%s: %s is named %s' % (name, *label['effects'], score.ranking(gap)[0]))
    # The same diagnoses, two of them falsified.
    wrong = next(name for name, label in labels.items() if 'air_drag' in label['effects'])
    alarm = next(name for name, label in labels.items() if label['kind'] == 'none')
    gaps[wrong]['effects'].reverse()
    gaps[alarm]['verdict'] = 'unexplained'
    other = score.report(labels, gaps, [], gapbench.effect_table(tool), {})
    for row, now, then in (
            ('| top-1 at 5× |', '(4 of 4)', '(3 of 4)'),
            ('| top-1, twin or baseline of the same motion: own |', '(3 of 3)', '(2 of 3)'),
            ('| top-1, twin or baseline of the same motion: FEM |', '(1 of 1)', '(1 of 1)'),
            ('| top-1, given a twin |', '(1 of 1)', '(1 of 1)'),
            ('| top-3 |', '(4 of 4)', '(3 of 4)'),
            ('| false alarm on unchanged cloth, all |', '(0 of 2)', '(1 of 2)'),
            ('| false alarm, own families, same motion |', '(0 of 2)', '(1 of 2)')):
        expect(now in text.split(row)[1].split('\n')[0] and
               then in other.split(row)[1].split('\n')[0], '%s %s, then %s' % (row, now, then))
    # the true effect takes off about what the found one does
    row = text.split('| shrink ÷ that of the true effect, median, baselines |')[1].split('|')[0]
    expect('(n = 3)' in row and abs(float(row.split()[0]) - 1.) < 0.1, 'share of the oracle' + row)
    named = gaps[wrong]['effects'][0]['name']
    column = [line.split() for line in other.split('\n') if line.endswith(' ' + named)][0][0]
    row = [line.split() for line in other.split('\n') if line.startswith('air_drag ')][0]
    expect(row[int(column)] == '1' and row.count('1') == 1, 'confused: ' + ' '.join(row))


with tempfile.TemporaryDirectory(prefix='cloth-gapbenchtest-') as scratch:
    made = os.path.join(scratch, 'run')
    intervals()
    spreads(scratch)
    gapbench.generate(families.Realities(tool, sys.argv[2]), made, 'few', 1000, 1)
    opened = seal.open_labels(os.path.join(made, 'sealed'), os.path.join(made, 'takes'))
    expect(len(opened) == 6, 'every commitment holds')
    blind(os.path.join(made, 'takes'), opened)
    refusals(made)
    diagnoses(made)
    scores(made, opened)
sys.exit(1 if faults else 0)
