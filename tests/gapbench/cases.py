"""Which cases the benchmark has: what acts in each, how strongly, in whose reality.

A case is a dict: kind (single, pair, none, outside, local), effects {name: {parameter: value}},
scaled {name: [parameter]} (those whose size is a measure), severity, family, baseline
(same: the same motion, other: another one), outside (name and size of what no effect of
the library is). Of those of the kind local, place and time are known.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
SEVERITIES = (0.7, 2., 5.)
# What is needed to be named is taken to be this part of the prior.
NEEDED = 0.5
# Force model, integrator and discretisation of what was recorded; diagnosed with an
# explicit membrane on the mesh as it is.
FAMILIES = {
    'springs-fine': {'force_model': 'mass-spring', 'effects': {'mesh_resolution': {'factor': 2}}},
    'springs-step': {'force_model': 'mass-spring', 'effects': {'time_step': {'factor': 0.5}}},
    'membrane-implicit-fine': {'force_model': 'membrane', 'integrator': 'implicit',
                               'time_step': 0.002,
                               'effects': {'mesh_resolution': {'factor': 2}}},
}
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
# What acts in a known place or from a known time on; so often each.
LOCAL = ('hem', 'slip', 'finger', 'ball')
N_LOCAL = 8
OUTSIDE = ('drift', 'wobble', 'clamp-shake', 'shaken-frame', 'obstacle', 'caught')


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


def make_case(kind, names, severity, table, family, baseline, random, outside=None):
    case = {'kind': kind, 'effects': {}, 'scaled': {}, 'severity': severity,
            'family': family, 'baseline': baseline, 'outside': outside}
    for name in names:
        case['effects'][name], case['scaled'][name] = set_effect(table[name], severity, random)
    return case


def list_few(table, random):
    """A handful for the test suite."""
    fine, step, implicit = FAMILIES
    return [make_case('single', ['air_drag'], 5., table, step, 'same', random),
            make_case('single', ['gravity_tilt'], 5., table, fine, 'same', random),
            make_case('single', ['mass_distribution'], 5., table, step, 'same', random),
            make_case('none', [], 0., table, step, 'same', random),
            make_case('none', [], 0., table, implicit, 'same', random)]


def list_all(table, random):
    """Families and baselines take turns, so that each effect meets several."""
    names = [name for name, effect in table.items()
             if effect['side'] in ('physics', 'clamp') and name not in ABSENT]
    families = list(FAMILIES)
    made = []

    def add(kind, effects, severity, outside=None):
        count = len(made)
        family = families[(count + count // 3) % 3]
        if any(name in MEMBRANE_ONLY for name in effects):
            family = 'membrane-implicit-fine'
        made.append(make_case(kind, effects, severity, table, family,
                              'other' if count % 4 == 3 else 'same', random, outside))

    for name in names:
        for severity in SEVERITIES:
            add('single', [name], severity)
    for pair in PAIRS:
        add('pair', list(pair), 3.)
    for _ in range(24):
        add('none', [], 0.)
    # Half of the controls have the same motion again, half another.
    for count, case in enumerate(case for case in made if case['kind'] == 'none'):
        case['baseline'] = ('same', 'other')[count % 2]
        case['family'] = families[count // 2 % 3]
        # Nobody hangs a cloth twice alike: every other one of the same motion bulges at first.
        case['bulge_m'] = 0.004 if count % 4 == 2 else 0.
    for name in OUTSIDE:
        for severity in (2., 5.):
            add('outside', [], severity, name)
    return made


def list_local(random):
    """Where and when is known: a heavy hem, a clamp that slips, a finger that takes hold of
    a patch and leads it, a ball that the cloth comes to touch."""
    made = []
    for count in range(N_LOCAL * len(LOCAL)):
        what, severity = LOCAL[count % len(LOCAL)], (2., 5.)[count // len(LOCAL) % 2]
        case = {'kind': 'local', 'effects': {}, 'scaled': {}, 'severity': severity,
                'family': list(FAMILIES)[(count + count // 3) % 3],
                'baseline': 'other' if count // len(LOCAL) % 4 == 3 else 'same', 'outside': what}
        way = random.normal(size=3)
        way /= (way ** 2).sum() ** 0.5
        if what == 'hem':
            case['effects'] = {'mass_distribution': {'factor': 1. + severity / 2.,
                                                     'height': random.uniform(0.03, 0.08)}}
        elif what == 'slip':
            case['effects'] = {'clamp_slip': dict(
                zip('xyz', (0.005 * severity * way).tolist()), held=int(random.integers(2)),
                time=random.uniform(0.9, 1.6))}
        made.append(case)
    return made
