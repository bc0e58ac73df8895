"""Which cases the benchmark has: what acts in each, how strongly, in whose reality, and what
the diagnosis is given beside the recording.

A case is a dict: kind (single, pair, none, outside, local), effects {name: {parameter: value}},
scaled {name: [parameter]} (those whose size is a measure), severity, family, evidence (one of
EVIDENCE), outside (what no effect of the library is), named (what may be said of it besides
`unexplained`), stranger (how a user's recording differs from the usual ones, or None), draw
(what its motion and numbers follow from). Of those of the kind local, place and time are known.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
SEVERITIES = (0.7, 2., 5.)
# What is needed to be named is taken to be this part of the prior.
NEEDED = 0.5

# The project's own simulator: force model, integrator and discretisation of what was recorded;
# diagnosed with an explicit membrane on the mesh as it is.
OWN = {
    'springs-fine': {'force_model': 'mass-spring', 'effects': {'mesh_resolution': {'factor': 2}}},
    'springs-step': {'force_model': 'mass-spring', 'effects': {'time_step': {'factor': 0.5}}},
    'membrane-implicit-fine': {'force_model': 'membrane', 'integrator': 'implicit',
                               'time_step': 0.002,
                               'effects': {'mesh_resolution': {'factor': 2}}},
}
FORCES = ('air_drag', 'air_drag_linear', 'air_drag_tangential', 'wind', 'gust', 'damping_mass',
          'gravity_tilt', 'gravity_scale', 'mass_distribution', 'shrinkage', 'clamp_slip',
          'clamp_delay')
# What the programs of the benchmark can do. Bullet's numbers of the material have no unit, so it
# has no effect of the material.
EXPRESSES = {
    'fem': FORCES + ('added_mass', 'areal_mass', 'bending', 'bending_anisotropy',
                     'bending_softening', 'stretch', 'stretch_anisotropy', 'shear', 'grain_angle',
                     'biphasic_stretch', 'hysteresis', 'damping_stiffness', 'plasticity',
                     'rest_curvature', 'clamp_compliance', 'friction'),
    'bullet': FORCES + ('friction',),
    'xpbd': FORCES + ('areal_mass', 'bending', 'stretch', 'stretch_anisotropy', 'shear',
                      'friction'),
}
# Families that no rule was made in view of.
UNSEEN = ('xpbd',)
OUTSIDE = tuple(EXPRESSES)

# What the diagnosis is given: what the same simulator made of the same clamps (twin; as often
# on another mesh), what another simulator or numbers of the material did (cousin), the cloth
# recorded before anything acted in the same or another motion, nothing.
EVIDENCE = ('twin', 'same', 'cousin', 'other', 'none')

# What shapes an effect, unlike what a diagnosis tries where it tries values of its own.
SHAPES = {
    'mass_distribution': {'height': 0.04}, 'biphasic_stretch': {'knee': 0.03},
    'plasticity': {'yield': 15.}, 'gust': {'time': 0.3, 'azimuth': 70.},
    'clamp_slip': {'time': 1.3, 'held': 1}, 'hysteresis': {'strain': 0.01},
}
SHAPING = ('height', 'knee', 'yield', 'strain', 'time', 'azimuth', 'coefficient',
           'turbulence', 'held')
# Nothing here that cloth could touch: neither can show.
ABSENT = ('friction', 'self_contact')
# Springs know no grain.
MEMBRANE_ONLY = ('grain_angle',)
PAIRS = (('air_drag', 'gravity_tilt'), ('wind', 'mass_distribution'), ('shrinkage', 'air_drag'),
         ('clamp_slip', 'air_drag'), ('gravity_tilt', 'bending'), ('stretch', 'damping_mass'),
         ('clamp_delay', 'mass_distribution'), ('areal_mass', 'wind'),
         ('rest_curvature', 'air_drag_linear'), ('shear', 'clamp_slip'))
N_CHANCE_PAIRS = 40
# So many of each evidence: none of 59 leaves less than 5% (one-sided).
N_NULLS = 59

# What acts in a known place or from a known time on; so often each.
LOCAL = ('hem', 'slip', 'finger', 'ball')
N_LOCAL = 8

# What no effect of physics or clamps is, and what may be said of it besides `unexplained`.
# Those designed are what the first design was made in view of.
DESIGNED = {'drift': (), 'wobble': (), 'clamp-shake': (), 'shaken-frame': (), 'obstacle': (),
            'caught': ()}
OPEN = {'scale': ('position_scale',), 'smoothed': ('smoothing',), 'labels': ('label_exchange',),
        'turned': ('misalignment',), 'thread': (), 'rain': ()}
# First diagnosed when the method is frozen.
RESERVED = {'frame-rate': ('time_scale',), 'late': ('recording_delay', 'clamp_delay'),
            'mirrored': ('axes_exchange',), 'pitched': ('misalignment', 'gravity_tilt'),
            'creep': (), 'seam': (), 'attraction': (), 'wet': (), 'tape': ()}
# Forces that only the finite elements know, and what only the own simulator does.
OF_FEM = ('thread', 'rain', 'creep', 'seam', 'attraction', 'wet', 'tape')
OF_OWN = ('caught',)

MOTIONS = ('swing', 'lift', 'shake', 'twist', 'release', 'one-sided', 'hang')
SETS = ('own', 'outside', 'pairs', 'nulls', 'unknown', 'strangers', 'local')


def set_effect(effect, severity, random):
    """An effect's parameters at a severity, in a direction by chance; and which scale."""
    name = effect['id']
    scaled = [p for p in effect['parameters'] if p['name'] not in SHAPING or
              len(effect['parameters']) == 1]
    direction = random.normal(size=len(scaled))
    direction /= (direction ** 2).sum() ** 0.5
    values = dict(SHAPES.get(name, {}))
    for share, p in zip(direction, scaled):
        # Cloth that is soft beyond a knee runs away in any simulator.
        share = abs(share) if p['one_sided'] or name == 'biphasic_stretch' else share
        value = p['null'] + share * severity * NEEDED * p['prior']
        values[p['name']] = float(min(max(value, p['range'][0]), p['range'][1]))
    return values, [p['name'] for p in scaled]


class Cases:
    """A list of cases in the making; draws by chance from one generator."""

    def __init__(self, table, random):
        self.table, self.random, self.made = table, random, []

    def add(self, kind, names, severity, family, evidence, outside=None, **more):
        case = {'kind': kind, 'effects': {}, 'scaled': {}, 'severity': severity,
                'family': family, 'evidence': evidence, 'outside': outside, 'named': [],
                'stranger': None, 'draw': len(self.made), **more}
        for name in names:
            case['effects'][name], case['scaled'][name] = set_effect(
                self.table[name], severity, self.random)
        self.made.append(case)
        return case

    def testable(self, family):
        """Effects of physics and clamps that can show in a family's reality."""
        return [name for name, effect in self.table.items()
                if effect['side'] in ('physics', 'clamp') and name not in ABSENT and
                (name in EXPRESSES[family] if family in EXPRESSES else
                 name not in MEMBRANE_ONLY or family == 'membrane-implicit-fine')]


def take_turns(count, *lists):
    """One of each list, so that in the long run each meets each."""
    out = []
    for choices in lists:
        out.append(choices[count % len(choices)])
        count = count // len(choices) + count
    return out


def list_few(table, random):
    """A handful for the test suite."""
    fine, step, implicit = OWN
    cases = Cases(table, random)
    cases.add('single', ['air_drag'], 5., step, 'same')
    cases.add('single', ['gravity_tilt'], 5., fine, 'same')
    cases.add('single', ['mass_distribution'], 5., step, 'twin')
    cases.add('single', ['wind'], 5., 'fem', 'same')
    cases.add('none', [], 0., step, 'same')
    cases.add('none', [], 0., implicit, 'same')
    return cases.made


def list_own(table, random):
    """Each effect at each severity; families and evidence take turns, so that each effect
    meets several."""
    cases = Cases(table, random)
    for name in cases.testable('membrane-implicit-fine'):
        for severity in SEVERITIES:
            count = len(cases.made)
            family = list(OWN)[(count + count // 3) % 3]
            if name in MEMBRANE_ONLY:
                family = 'membrane-implicit-fine'
            cases.add('single', [name], severity, family, EVIDENCE[(count + count // 15) % 5])
    return cases.made


def list_outside(table, random):
    """Each effect that a family outside can express, at 2x and 5x."""
    cases = Cases(table, random)
    for family in OUTSIDE:
        for name in cases.testable(family):
            for severity in SEVERITIES[1:]:
                count = len(cases.made)
                cases.add('single', [name], severity, family, EVIDENCE[(count + count // 10) % 5])
    return cases.made


def list_pairs(table, random):
    """The listed pairs in the own families, then any two by chance in all."""
    cases = Cases(table, random)
    evidence = EVIDENCE[:-1]
    for count, pair in enumerate(PAIRS):
        cases.add('pair', list(pair), 3., list(OWN)[count % 3], evidence[count % 4], listed=True)
    for count in range(N_CHANCE_PAIRS):
        family = (list(OWN) + list(OUTSIDE))[count % 6]
        names = [str(name) for name in random.choice(cases.testable(family), 2, replace=False)]
        cases.add('pair', names, float(random.uniform(2., 5.)), family,
                  evidence[(count + count // 6) % 4], listed=False)
    return cases.made


def list_nulls(table, random):
    """Unchanged cloth: as often with each evidence in the own families as outside them. Nobody
    hangs a cloth twice alike: every fourth bulges at first."""
    cases = Cases(table, random)
    for count in range(N_NULLS):
        for evidence in EVIDENCE:
            for family in (list(OWN)[count % 3], OUTSIDE[count % 3]):
                cases.add('none', [], 0., family, evidence,
                          bulge_m=0.004 if count % 4 == 3 else 0.)
    return cases.made


def list_unknown(table, random, reserved):
    cases = Cases(table, random)
    for kinds in ((RESERVED,) if reserved else (DESIGNED, OPEN)):
        for name, named in kinds.items():
            for severity in (2., 5.):
                for turn in range(2):
                    count = len(cases.made)
                    families = ['fem'] if name in OF_FEM else list(OWN) if name in OF_OWN else \
                        list(OWN) + list(OUTSIDE)
                    cases.add('outside', [], severity, families[(count + turn) % len(families)],
                              EVIDENCE[(count + count // 4) % 4], name, named=list(named),
                              designed=name in DESIGNED)
    return cases.made


def choose_stranger(random, motion):
    """How a user records: rates, lengths, noise, clocks and cloths of their own."""
    across = int(random.integers(7, 13))
    held = 'corners' if motion in ('release', 'twist', 'one-sided') else \
        str(random.choice(('corners', 'edge', 'four', 'middle')))
    return {'motion': motion, 'held': held, 'fps': float(random.choice((25., 30., 50., 100.))),
            'seconds': float(random.uniform(1., 4.)),
            'noise_m': float(10. ** random.uniform(-3.52, -2.)),
            'jitter_s': float(random.choice((0., 1e-3))), 'dropped': float(
                random.choice((0., 0.03))),
            'columns': across + (1 - across % 2 if held == 'middle' else 0),
            'rows': int(random.integers(7, 13)), 'width_m': float(random.uniform(0.16, 0.4)),
            'aspect': float(random.uniform(0.7, 1.4)),
            'origin_m': [float(part) for part in random.normal(size=3) * 5e-3]}


def list_strangers(table, random):
    """Effects and unchanged cloth as users record them; and recordings that differ only in that
    their frames come 1 ms (standard deviation) too early or too late."""
    cases = Cases(table, random)
    families = list(OWN) + list(OUTSIDE)
    for count in range(60):
        family = families[count % 6]
        motion, evidence = MOTIONS[count % 7], EVIDENCE[(count + count // 30) % 5]
        stranger = choose_stranger(random, motion)
        if count % 5 < 3:
            name = str(random.choice(cases.testable(family)))
            cases.add('single', [name], 5., family, evidence, stranger=stranger)
        else:
            cases.add('none', [], 0., family, evidence, stranger=stranger)
    for count in range(20):
        family = families[count % 6]
        names = [] if count % 2 else [str(random.choice(cases.testable(family)))]
        case = cases.add('single' if names else 'none', names, 5. if names else 0., family,
                         EVIDENCE[count // 2 % 4], usual=True)
        # the same in all else
        jittered = dict(case, stranger={'jitter_s': 1e-3}, jitter_of=case['draw'])
        cases.made.append(jittered)
    return cases.made


def list_local(table, random):
    """Where and when is known: a heavy hem, a clamp that slips, a finger that takes hold of
    a patch and leads it, a ball that the cloth comes to touch."""
    cases = Cases(table, random)
    for count in range(N_LOCAL * len(LOCAL)):
        what, severity = LOCAL[count % len(LOCAL)], (2., 5.)[count // len(LOCAL) % 2]
        case = cases.add('local', [], severity, list(OWN)[(count + count // 3) % 3],
                         EVIDENCE[(count // len(LOCAL) + count) % 4], what)
        way = random.normal(size=3)
        way /= (way ** 2).sum() ** 0.5
        if what == 'hem':
            case['effects'] = {'mass_distribution': {'factor': 1. + severity / 2.,
                                                     'height': random.uniform(0.03, 0.08)}}
        elif what == 'slip':
            case['effects'] = {'clamp_slip': dict(
                zip('xyz', (0.005 * severity * way).tolist()), held=int(random.integers(2)),
                time=random.uniform(0.9, 1.6))}
    return cases.made


def list_set(name, table, random, reserved=False):
    if name == 'unknown':
        return list_unknown(table, random, reserved)
    return {'few': list_few, 'own': list_own, 'outside': list_outside, 'pairs': list_pairs,
            'nulls': list_nulls, 'strangers': list_strangers, 'local': list_local}[name](
                table, random)
