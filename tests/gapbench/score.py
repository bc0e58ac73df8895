"""Holds diagnoses against opened labels; writes the table and the confusion matrix.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import math
import statistics

from cases import DESIGNED, OWN, SEVERITIES, UNSEEN

SILENT = ('no_gap', 'undecidable')
# One force, where the areal mass is even.
SAME_FORCE = {'damping_mass', 'air_drag_linear'}


def binomial_interval(hits, count):
    """The exact 95% interval of a share (Clopper and Pearson 1934), by bisection."""
    def at_most(k, share):
        return sum(math.comb(count, i) * share ** i * (1. - share) ** (count - i)
                   for i in range(k + 1))

    def solve(k, tail):
        low, high = 0., 1.
        for _ in range(60):
            middle = (low + high) / 2.
            low, high = (middle, high) if at_most(k, middle) > tail else (low, middle)
        return low

    if not count:
        return 0., 1.
    return (0. if hits == 0 else solve(hits - 1, 0.975),
            1. if hits == count else solve(hits, 0.025))


def share(hits):
    hits = list(hits)
    if not hits:
        return 'no case'
    low, high = binomial_interval(sum(hits), len(hits))
    return '%.0f%% (%d of %d) [%.0f, %.0f]' % (100. * sum(hits) / len(hits), sum(hits), len(hits),
                                              100. * low, 100. * high)


def ranking(gap):
    return [effect['name'] for effect in gap['effects']]


def ambiguity_set(gap):
    """What is reported together with the first: the effects of the likeliest explanations that
    have 95% between them; of the first design, whose gap.json has none, the first one's group."""
    if gap.get('sets'):
        named, total = [], 0.
        for one in gap['sets']:
            named += [name for name in one['effects'] if name not in named]
            total += one['probability'] or 0.
            if total >= 0.95:
                break
        return named
    if not gap['effects']:
        return []
    first = gap['effects'][0]
    named = [first['name']]
    if first['group'] is not None:
        named += [name for name in gap['groups'][first['group']]['effects'] if name not in named]
    return named


def named_first(gap, label):
    return ranking(gap)[:1] == list(label['effects'])


def force_named_first(gap, label):
    """The effect, or the one that is the same force, is first."""
    first, acted = set(ranking(gap)[:1]), set(label['effects'])
    return first == acted or bool(first & SAME_FORCE and acted & SAME_FORCE)


def accepted(gap):
    return {effect['name'] for effect in gap['effects'] if effect['accepted']}


def is_right(gap, label):
    """An effect at 2× or 5× that is named first and accepted."""
    return (label['kind'] == 'single' and label['severity'] >= 2. and named_first(gap, label)
            and set(label['effects']) <= accepted(gap))


def share_of_oracle(gap, oracle):
    """What the accepted effects take off the gap, as a share of what the true one takes off;
    None where that is not a tenth of the gap."""
    before, after = gap['gap_before']['value'] ** 2, gap['gap_after']['value'] ** 2
    if oracle is None or before - oracle < 0.1 * before:
        return None
    return (before - after) / (before - oracle)


def floors_of(gap, label):
    """How far an effect moved the cloth, as a multiple of the diagnosis's noise floor."""
    floor = gap['noise_floor']['value']
    return label['size_m'] / floor if floor else math.inf


def parameters_of(gap, label, table):
    """(estimate, sigma, truth, null) of what was scaled in the effect that was found."""
    for effect in gap['effects']:
        if effect['name'] in label['effects'] and effect['accepted']:
            nulls = {p['name']: p['null'] for p in table[effect['name']]['parameters']}
            for p in effect['parameters']:
                if p['name'] in label['scaled'][effect['name']] and p['value'] is not None:
                    yield (p['value'], p['sigma'], label['effects'][effect['name']][p['name']],
                           nulls[p['name']])


def first_ones(cases):
    """(probability of what stands first, whether it acted)."""
    for label, gap in cases:
        if gap['effects'] and gap['effects'][0]['probability'] is not None:
            yield gap['effects'][0]['probability'], ranking(gap)[0] in label['effects']


def calibration_error(pairs):
    """Expected calibration error in ten bins of probability."""
    total = 0.
    for step in range(10):
        held = [(p, hit) for p, hit in pairs if min(int(10 * p), 9) == step]
        if held:
            total += abs(sum(p for p, _ in held) - sum(hit for _, hit in held))
    return total / len(pairs) if pairs else math.nan


def log_score(pairs):
    """Mean of -log of the probability of what was the case (Good 1952), at least 1e-6."""
    return -statistics.mean(math.log(max(p if hit else 1. - p, 1e-6))
                            for p, hit in pairs) if pairs else math.nan


def area_under_curve(flagged, others):
    """How often one of `flagged` is above one of `others`: the area under the curve of hits
    against false alarms (Hanley and McNeil 1982)."""
    pairs = [(a > b) + 0.5 * (a == b) for a in flagged for b in others]
    return '%.2f (n = %d and %d)' % (statistics.mean(pairs), len(flagged),
                                     len(others)) if pairs else 'no case'


def strangeness(gap):
    """Orders diagnoses by how little the library accounts for: by the probability of the two
    generic rivals; of the first design by the verdict, then by what remains as a multiple of the
    noise floor."""
    rivals = gap.get('rivals') or {}
    if rivals.get('force_field') is not None:
        return rivals['force_field'] + rivals['displacement_field']
    rest = gap['gap_after']['value'] or gap['gap_before']['value']
    floor = gap['noise_floor']['value']
    return gap['verdict'] == 'unexplained', rest / floor if rest and floor else 0.


def named_otherwise(gap, label):
    """A fault of the measurement that has a name is named by it and accepted."""
    return bool(set(ranking(gap)[:1]) & set(label['named']) & accepted(gap))


def beyond_limit(gap, label):
    """Whether what acted is larger than the diagnosis says would show; None where it says
    nothing."""
    limits = [limit for limit in gap.get('detection_limits') or [] if limit['value'] is not None
              and limit['effect'] in label['effects']]
    if not limits:
        return None
    return any(abs(label['effects'][limit['effect']].get(limit['parameter'], math.nan) -
                   label['nulls'][limit['effect']][limit['parameter']]) > limit['value']
               for limit in limits)


def low_decile(values, form):
    values = sorted(values)
    return form % values[int(0.1 * len(values))] if values else 'no case'


def median(values, form):
    values = list(values)
    return form % statistics.median(values) + ' (n = %d)' % len(values) if values else 'no case'


def overlap(gap, label):
    """Intersection over union of where a gap was found and where its force acts."""
    found, truth = set(gap['where']['region'] or []), set(label['region'])
    return len(found & truth) / len(found | truth)


def onset_error(gap, label):
    """In frames; endless when it was not found."""
    onset = gap['where']['onset_s']
    return math.inf if onset is None else abs(onset - label['onset_s']) * label['fps']


def places_of(cases):
    """Rows of where and when."""
    local = [c for c in cases if c[0]['kind'] == 'local']
    placed = [(g, l) for l, g in local if l['region']]
    begun = [(g, l) for l, g in local if l['onset_s'] is not None]
    none = [g for l, g in cases if l['kind'] == 'none']
    rows = [('localisation IoU, median', median((overlap(*c) for c in placed), '%.2f'), '≥ 0.5'),
            ('localisation IoU of 0.5 or more', share(overlap(*c) >= 0.5 for c in placed), '')]
    for what in sorted({l['outside'] for _, l in placed}):
        rows.append(('localisation IoU, median, %s' % what, median(
            (overlap(g, l) for g, l in placed if l['outside'] == what), '%.2f'), ''))
    return rows + [
        ('onset error, median, frames', median((onset_error(*c) for c in begun), '%.0f'), '≤ 3'),
        ('onset within 3 frames', share(onset_error(*c) <= 3.01 for c in begun), ''),
        ('there from the beginning: no onset told', share(
            g['where']['onset_s'] is None for l, g in local if l['onset_s'] is None), ''),
        ('no gap: a place is told', share(bool(g['where']['region']) for g in none), '≤ 5%')]


def is_usual(label):
    return label['stranger'] is None and 'jitter_of' not in label


def families_of(label):
    return 'own' if label['family'] in OWN else label['family']


def first_of(cases):
    return share(named_first(g, l) for l, g in cases)


def alarms(cases):
    return share(g['verdict'] not in SILENT for _, g in cases)


def names_of(strong):
    """Rows of what is named, by what the diagnosis was given."""
    aims = {'own': '≥ 95%', 'fem': '≥ 95%'}
    rows = []
    for title, belongs in (('own', 'own'), ('FEM', 'fem'), ('Bullet', 'bullet'),
                           ('XPBD', 'xpbd')):
        here = [c for c in strong if families_of(c[0]) == belongs]
        alike = [c for c in here if c[0]['evidence'] in ('twin', 'same')]
        other = [c for c in here if c[0]['evidence'] == 'other']
        rows.append(('top-1, twin or baseline of the same motion: ' + title, first_of(alike),
                     aims.get(belongs, '≥ 90%')))
        rows.append(('top-1, baseline of another motion: ' + title, first_of(other), '≥ 85%'))
    for evidence, title in (('twin', 'a twin'), ('cousin', 'a cousin'),
                            ('same', 'a baseline of the same motion'),
                            ('other', 'a baseline of another motion'), ('none', 'nothing')):
        rows.append(('top-1, given %s' % title,
                     first_of([c for c in strong if c[0]['evidence'] == evidence]), ''))
    other = [c for c in strong if c[0]['evidence'] == 'other']
    rows += [
        ('named right and accepted, another motion',
         share(named_first(g, l) and set(l['effects']) <= accepted(g) for l, g in other),
         '≥ 75%'),
        ('wrong extra effect accepted',
         share(bool(accepted(g) - set(l['effects'])) for l, g in strong), '≤ 5%'),
        ('the same, damping_mass and air_drag_linear counted as one',
         share(force_named_first(g, l) for l, g in strong), ''),
        ('top-3', share(bool(set(ranking(g)[:3]) & set(l['effects'])) for l, g in strong), ''),
        ('ambiguity set holds the truth',
         share(bool(set(ambiguity_set(g)) & set(l['effects'])) for l, g in strong), '≥ 95%'),
        ('mean size of the ambiguity set',
         '%.2f' % statistics.mean(len(ambiguity_set(g)) for _, g in strong) if strong else
         'no case', '')]
    return rows


def nulls_of(none):
    """Rows of false alarms."""
    rows = [('false alarm on unchanged cloth, all', alarms(none), '≤ 5%')]
    for title, inside in (('own', True), ('outside', False)):
        here = [c for c in none if (c[0]['family'] in OWN) == inside]
        for evidence, given in (('twin', 'twin'), ('cousin', 'cousin'), ('same', 'same motion'),
                                ('other', 'another motion'), ('none', 'no baseline')):
            rows.append(('false alarm, %s families, %s' % (title, given), alarms(
                [c for c in here if c[0]['evidence'] == evidence]), '≤ 5%'))
    rows.append(('false alarm, cloth that bulges by 4 mm at first',
                 alarms([c for c in none if c[0].get('bulge_m')]), ''))
    rows.append(('unchanged cloth called undecidable',
                 share(g['verdict'] == 'undecidable' for _, g in none), ''))
    return rows


def pairs_of(pairs):
    def whole(chosen):
        return share(set(ranking(g)[:2]) == set(l['effects']) for l, g in chosen)

    def second(gap, label):
        return min((e['log_bayes_factor'] or -math.inf for e in gap['effects']
                    if e['name'] in label['effects']), default=-math.inf)

    chance = [c for c in pairs if not c[0]['listed']]
    return [
        ('pairs, both first: listed', whole([c for c in pairs if c[0]['listed']]), '≥ 85%'),
        ('pairs by chance, both first', whole(chance), ''),
        ('the same, with 5 nats or more for the second',
         whole([(l, g) for l, g in chance if second(g, l) >= 5.]), '≥ 85%'),
        ('the same, where each moves the cloth by half a floor beyond the other',
         whole([(l, g) for l, g in chance
                if l['second_m'] >= 0.5 * (g['noise_floor']['value'] or 0.)]), ''),
        ('pairs: exactly both accepted',
         share(accepted(g) == set(l['effects']) for l, g in pairs), '')]


def unknown_of(cases):
    """Rows of what no effect is; those that were named as what they are count as found."""
    known = [strangeness(g) for l, g in cases if l['kind'] in ('single', 'pair', 'none')]
    rows = []
    for title, designed, aim in (('designed for', True, '≥ 0.92'),
                                 ('not designed for', False, '≥ 0.85')):
        here = [c for c in cases if c[0]['kind'] == 'outside' and
                (c[0]['outside'] in DESIGNED) == designed]
        rows += [
            ('unknowns, kinds %s: AUROC against all else' % title, area_under_curve(
                [strangeness(g) for l, g in here if not named_otherwise(g, l)], known), aim),
            ('unknowns, kinds %s: `unexplained` or named as the fault it is' % title,
             share(g['verdict'] == 'unexplained' or named_otherwise(g, l) for l, g in here), ''),
            ('the same, where it moves the cloth by half a floor or more', share(
                g['verdict'] == 'unexplained' or named_otherwise(g, l) for l, g in here
                if floors_of(g, l) >= 0.5), ''),
            ('unknowns, kinds %s: explained by a wrong effect' % title,
             share(g['verdict'] in ('explained', 'ambiguous') and not named_otherwise(g, l)
                   for l, g in here), '')]
    return rows


def numbers_of(single, right, table, oracles):
    """Rows of how large effects were found to be, and of what they take off."""
    rows = []
    for title, belongs in (('own', ('own',)), ('FEM', ('fem',)), ('others', ('bullet', 'xpbd'))):
        found = [p for l, g in single if families_of(l) in belongs
                 for p in parameters_of(g, l, table)]
        rows += [
            ('95%% intervals hold the truth: %s' % title,
             share(abs(value - truth) <= 1.96 * sigma for value, sigma, truth, _ in found
                   if sigma is not None), '90–98%'),
            ('parameter error, median: %s' % title,
             median((abs(value - truth) / abs(truth - null) for value, _, truth, null in found
                     if truth != null), '%.2f'), '≤ 0.10')]
    shares = [part for part in (share_of_oracle(g, oracles.get(l['case'])) for l, g in right)
              if part is not None]
    return rows + [
        ('shrink ÷ that of the true effect, median, baselines', median(shares, '%.2f'), ''),
        ('its 10% quantile', low_decile(shares, '%.2f'), '')]


def strangers_of(cases):
    """Rows of recordings as users make them, of recordings without a baseline, of clocks."""
    strange = [c for c in cases if c[0]['stranger'] and is_stranger(c[0])]
    alone = [c for c in cases if c[0]['evidence'] == 'none' and c[0]['kind'] == 'single']
    held = [(l, g, beyond_limit(g, l)) for l, g in cases if l['kind'] == 'single']
    by_case = {(l.get('folder'), l['draw'], 'jitter_of' in l): g for l, g in cases
               if 'jitter_of' in l or l.get('usual')}
    both = [(g, by_case[folder, draw, True]) for (folder, draw, jitter), g in by_case.items()
            if not jitter and (folder, draw, True) in by_case]
    return [
        ('strangers’ recordings: top-1', first_of(
            [c for c in strange if c[0]['kind'] == 'single' and c[0]['evidence'] != 'none']), ''),
        ('strangers’ recordings: false alarm',
         alarms([c for c in strange if c[0]['kind'] == 'none']), '≤ 5%'),
        ('strangers’ recordings, no baseline: named or undecidable', share(
            named_first(g, l) or g['verdict'] == 'undecidable' for l, g in strange
            if l['kind'] == 'single' and l['evidence'] == 'none'), ''),
        ('no baseline: gap of 2 floors or more called `no_gap`', share(
            g['verdict'] == 'no_gap' for l, g in alone if floors_of(g, l) >= 2.), '0'),
        ('no baseline: named or undecidable', share(
            named_first(g, l) or g['verdict'] == 'undecidable' for l, g in alone), ''),
        ('what is beyond its detection limit is not silent',
         share(g['verdict'] not in SILENT for _, g, beyond in held if beyond), '≥ 90%'),
        ('the same, no baseline', share(g['verdict'] not in SILENT for l, g, beyond in held
                                        if beyond and l['evidence'] == 'none'), '≥ 90%'),
        ('frame times jittered by 1 ms: same verdict as without',
         share(one['verdict'] == other['verdict'] for one, other in both), '≥ 95%'),
        ('frame times jittered by 1 ms: same effect first',
         share(ranking(one)[:1] == ranking(other)[:1] for one, other in both), '')]


def is_stranger(label):
    return 'motion' in (label['stranger'] or {})


def table_of(cases, table, oracles):
    """The rows of the table: (figure, measured, to reach)."""
    usual = [c for c in cases if is_usual(c[0])]
    known = [c for c in usual if c[0]['kind'] != 'local']
    single = [c for c in usual if c[0]['kind'] == 'single']
    strong = [c for c in single if c[0]['severity'] >= 2.]
    alike = [c for c in strong if c[0]['evidence'] != 'none']
    right = [c for c in alike if is_right(c[1], c[0])]
    rows = names_of(alike + [c for c in strong if c[0]['evidence'] == 'none'])
    for severity in SEVERITIES:
        rows.append(('top-1 at %g×' % severity,
                     first_of([c for c in single if c[0]['severity'] == severity]), ''))
    for low, high, text in ((2., math.inf, 'by 2 floors or more'), (0.5, 2., 'by 0.5 to 2 floors'),
                            (0., 0.5, 'by less')):
        rows.append(('top-1, the effect moves the cloth %s' % text,
                     first_of([(l, g) for l, g in single if low <= floors_of(g, l) < high]), ''))
    rows += nulls_of([c for c in usual if c[0]['kind'] == 'none'])
    rows += pairs_of([c for c in usual if c[0]['kind'] == 'pair'])
    rows += unknown_of(usual)
    rows += numbers_of(single, right, table, oracles)
    rows += [('calibration error of the first one’s probability (ECE)',
              '%.2f' % calibration_error(list(first_ones(known))), '≤ 0.05'),
             ('its log score, nats', '%.2f' % log_score(list(first_ones(known))), '')]
    return rows + places_of(usual) + strangers_of(cases)


def by_family(cases):
    """Lines of a table: what is reached in each family alone."""
    yield '| family | rules were made in view of it | top-1, same motion or twin |' \
        ' top-1, another motion | false alarm |'
    yield '|---' * 5 + '|'
    usual = [c for c in cases if is_usual(c[0])]
    for family in sorted({l['family'] for l, _ in usual}):
        here = [c for c in usual if c[0]['family'] == family]
        strong = [c for c in here if c[0]['kind'] == 'single' and c[0]['severity'] >= 2.]
        yield '| %s | %s | %s | %s | %s |' % (
            family, 'no' if family in UNSEEN else 'yes',
            first_of([c for c in strong if c[0]['evidence'] in ('twin', 'same')]),
            first_of([c for c in strong if c[0]['evidence'] == 'other']),
            alarms([c for c in here if c[0]['kind'] == 'none']))


def confusion(cases):
    """Lines of a matrix: what acted, against what stood first or that all was silent."""
    counts = {}
    for label, gap in cases:
        truth = '+'.join(sorted(label['effects'])) or label['outside'] or '(nothing)'
        found = '(%s)' % gap['verdict'] if gap['verdict'] in SILENT else ranking(gap)[0] \
            if gap['effects'] else '(none tested)'
        row = counts.setdefault((label['kind'], truth), {})
        row[found] = row.get(found, 0) + 1
    order = ('single', 'none', 'outside', 'pair', 'local')
    rows = sorted(counts, key=lambda key: (order.index(key[0]), key[1]))
    columns = sorted({name for row in counts.values() for name in row})
    lines = ['columns:']
    lines += ['%5d %s' % (i + 1, name) for i, name in enumerate(columns)]
    lines += ['', '%-34s' % 'acted' + ''.join('%3d' % (i + 1) for i in range(len(columns)))]
    for key in rows:
        lines.append('%-34s' % key[1] + ''.join(
            '%3s' % (counts[key].get(name) or '·') for name in columns))
    return lines


def verdicts(cases):
    names = ('no_gap', 'explained', 'ambiguous', 'unexplained', 'undecidable')
    yield '| cases | ' + ' | '.join('`%s`' % name for name in names) + ' |'
    yield '|---' * 6 + '|'
    groups = [('one effect at %g×' % s, lambda l, s=s: l['kind'] == 'single' and
               l['severity'] == s) for s in SEVERITIES]
    groups += [(text, lambda l, kind=kind: l['kind'] == kind) for kind, text in (
        ('pair', 'pairs'), ('none', 'no gap'), ('outside', 'out of the library'),
        ('local', 'in one place'))]
    for text, belongs in groups:
        here = [gap['verdict'] for label, gap in cases if belongs(label)]
        yield '| %s | ' % text + ' | '.join(str(here.count(name)) for name in names) + ' |'


def each(cases):
    """Every case in a line, for who wants to look at one."""
    for label, gap in sorted(cases, key=lambda c: c[0]['case']):
        what = ', '.join('%s %s' % (name, ' '.join('%s=%.3g' % item
                                                   for item in sorted(values.items())))
                         for name, values in label['effects'].items())
        first = ['%s %.2f%s' % (e['name'], e['probability'] if e['probability'] is not None
                                else math.nan, '*' if e['accepted'] else '')
                 for e in gap['effects'][:3]]
        where = ''
        if label['kind'] == 'local':
            where = '; at %d of %s, %.2f; from %s of %s s' % (
                len(gap['where']['region'] or []), len(label['region'] or []) or '-',
                overlap(gap, label) if label['region'] else math.nan, gap['where']['onset_s'],
                label['onset_s'])
        yield '%s %s %s %g× %s, given %s, %.2f mm: %s; %s%s' % (
            label['case'], label['kind'], what or label['outside'] or '-', label['severity'],
            label['family'], label['evidence'], 1000. * label['size_m'], gap['verdict'],
            ', '.join(first), where)


def report(labels, gaps, left, table, oracles):
    """The whole as markdown; @gaps by case, @left those that have none, @oracles the squared
    gaps with what was really done, of those that are right."""
    # In some realities an effect does nothing at all.
    idle = [case for case in sorted(gaps) if labels[case]['kind'] not in ('none', 'outside') and
            labels[case]['size_m'] == 0.]
    nulls = {name: {p['name']: p['null'] for p in effect['parameters']}
             for name, effect in table.items()}
    cases = [(dict(labels[case], nulls=nulls), gaps[case]) for case in sorted(gaps)
             if case not in idle]
    seconds = [gap['seconds'] for _, gap in cases]
    lines = ['%d cases diagnosed, %d not; %.1f s each in the median;'
        ' noise floor in the median %s.' % (
        len(cases), len(left), statistics.median(seconds) if seconds else math.nan,
        median((1000. * gap['noise_floor']['value'] for _, gap in cases
                if gap['noise_floor']['value'] is not None), '%.1f mm')), '',
        '| figure | measured [95% interval] | to reach |', '|---|---|---|']
    lines += ['| %s | %s | %s |' % row for row in table_of(cases, table, oracles)
              if row[1] not in ('no case', 'nan')]
    lines += ['', *by_family(cases), '', *verdicts(cases), '', '```text', *confusion(cases), '```']
    lines += ['', 'Not counted, the effect did nothing there: ' + ', '.join(
        '%s (%s)' % (case, ' '.join(labels[case]['effects'])) for case in idle)] if idle else []
    lines += ['', 'Not diagnosed: ' + ', '.join(
        '%s (%s)' % (case, '+'.join(labels[case]['effects']) or labels[case]['outside'] or
                     'nothing') for case in left)] if left else []
    return '\n'.join(lines) + '\n'


def write_cases(path, labels, gaps):
    with open(path, 'w', encoding='utf-8') as file:
        for line in each([(labels[case], gap) for case, gap in gaps.items()]):
            file.write(line + '\n')
