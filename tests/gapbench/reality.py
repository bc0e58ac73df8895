"""Makes recordings of small cloths: simulated otherwise than the diagnosis does, noisy, in part
unseen; and what a user has beside them.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import copy
import os

import numpy

import families
from cases import OUTSIDE, OWN
from families import HZ, MODEL

CLOTH = {'columns': 9, 'rows': 10, 'width_m': 0.22, 'height_m': 0.24}
# Before the recording begins the clamps close and the cloth comes to hang.
BEFORE = 0.5
USUAL = {'motion': 'sway', 'held': 'corners', 'fps': 50., 'seconds': 1.5, 'noise_m': None,
         'jitter_s': 0., 'dropped': 0., 'origin_m': [0., 0., 0.]}
# What a place is known by: the same noise everywhere, or two cameras a stride away and 18° apart,
# the second of which has the right half of the cloth three times less sharp; covariances are
# written beside, or left out.
NOISES = ('even', 'cameras', 'cameras-untold')
CAMERAS = numpy.array([[-0.16, -1., 0.1], [0.16, -1., 0.1]])
HELD = {'corners': [(0., 0.), (1., 0.)], 'edge': [(0., 0.), (1., 0.)],
        'four': [(0., 0.), (1., 0.), (0., 1.), (1., 1.)],
        'middle': [(0., 0.), (1., 0.), (0.5, 0.)]}


def diagnosed_model():
    """What is known of the cloth: about right, and free to be fitted."""
    model = copy.deepcopy(MODEL)
    model['free'] = []
    for name in ('stretch.warp', 'stretch.weft', 'shear', 'bending.warp', 'bending.weft',
                 'damping.mass', 'damping.stiffness'):
        value = model
        for key in name.split('.'):
            value = value[key]
        model['free'].append({'name': name, 'range': [value / 30., value * 30.]})
    return model


def choose_motion(name, random):
    """How the clamps go: kind, amplitudes, frequencies and phases."""
    return {'name': name, 'close': random.uniform(0.03, 0.05),
            'across': random.uniform(0.03, 0.05, 2), 'along': random.uniform(0.005, 0.02),
            'up': random.uniform(0.005, 0.02), 'hz': random.uniform(0.9, 1.7, 3),
            'phase': random.uniform(0., 6.28, 3), 'share': random.uniform(0.5, 1.)}


def wave(hz, t, phase=0.):
    return numpy.sin(6.2832 * hz * t + phase) - numpy.sin(phase)


def place_ends(motion, t, width):
    """What the left and the right end are moved by, [time][2][3], over the closing."""
    out = numpy.zeros((len(t), 2, 3))
    hz, phase, share = motion['hz'], motion['phase'], motion['share']
    after = numpy.clip(t, 0., None)
    if motion['name'] == 'sway':
        for end in range(2):
            out[:, end, 0] = motion['along'] * wave(hz[1], t, phase[1])
            out[:, end, 1] = motion['across'][end] * wave(hz[0], t, phase[0])
            out[:, end, 2] = motion['up'] * wave(hz[2], t, phase[2])
    elif motion['name'] == 'swing':
        # As a robot does: one axis, far and slow.
        out[:, :, 1] = (0.15 * share * wave(0.5 * hz[0] - 0.1, t))[:, None]
    elif motion['name'] == 'lift':
        out[:, :, 2] = (0.06 * share * (1. - numpy.cos(6.2832 * 0.7 * hz[0] * after)))[:, None]
    elif motion['name'] == 'shake':
        out[:, :, 1] = (0.015 * share * wave(2.5 * hz[0], after))[:, None]
    elif motion['name'] == 'twist':
        angle = 0.8 * share * wave(0.6 * hz[0], t)
        for end, side in enumerate((-0.5, 0.5)):
            out[:, end, 0] = side * width * (numpy.cos(angle) - 1.)
            out[:, end, 1] = side * width * numpy.sin(angle)
    elif motion['name'] == 'one-sided':
        out[:, 1, 1] = 0.08 * share * wave(0.7 * hz[0], t)
        out[:, 1, 0] = -0.02 * (1. - numpy.cos(6.2832 * 0.7 * hz[0] * after))
    elif motion['name'] == 'hang':
        out[:, :, 1] = (0.004 * share * wave(hz[0], t, phase[0]))[:, None]
    elif motion['name'] == 'release':
        out[:, :, 1] = (0.03 * share * wave(0.8 * hz[0], t))[:, None]
    return out


def choose_setup(case, random):
    """The cloth, how it is held and for how long; not yet how it moves."""
    how = dict(USUAL, **(case['stranger'] or {}))
    cloth = CLOTH
    if 'columns' in how:
        cloth = {'columns': how['columns'], 'rows': how['rows'], 'width_m': how['width_m'],
                 'height_m': how['width_m'] * how['aspect']}
    return {'noise': 'even', 'cloth': cloth, 'held': HELD[how['held']], 'edge': how['held'] == 'edge',
            'bulge_m': 0., 'how': how, 'until_s': {}, 'motion': choose_motion(
                how['motion'], random)}


def move(setup, random):
    """Gives a setup its paths; each time the same motion is repeated it is so to 0.3 mm."""
    how, cloth = setup['how'], setup['cloth']
    t = numpy.arange(int((BEFORE + how['seconds'] + 0.2) * HZ)) / HZ - BEFORE
    ramp = numpy.clip((t + BEFORE) / 0.4, 0., 1.)
    ramp = ramp ** 2 * (3. - 2. * ramp)
    ends = place_ends(setup['motion'], t, cloth['width_m'])
    # A bar doesn't close.
    close = 0. if setup['edge'] else setup['motion']['close'] * cloth['width_m'] / 0.22
    paths = numpy.zeros((len(t), len(setup['held']), 3))
    for held, (across, down) in enumerate(setup['held']):
        paths[:, held] = (1. - across) * ends[:, 0] + across * ends[:, 1]
        paths[:, held, 0] += (0.5 - across) * close
        paths[:, held] += down * numpy.array([0., 0.03, 0.15 * cloth['height_m']])
        for axis in range(3):
            paths[:, held, axis] += 2e-4 * random.normal() * numpy.sin(
                6.2832 * random.uniform(0.5, 2.) * t)
        paths[:, held] *= ramp[:, None]
        paths[:, held] += numpy.array([across * cloth['width_m'], 0., -down * cloth['height_m']])
    setup = dict(setup, paths=paths + how['origin_m'])
    if setup['motion']['name'] == 'release':
        setup['until_s'] = {1: BEFORE + 0.4 * how['seconds']}
    return setup


def times_of(how, random):
    """When pictures were taken, from the recording's beginning on."""
    times = numpy.arange(int(round(how['seconds'] * how['fps']))) / how['fps']
    times = times[random.random(len(times)) >= how['dropped']]
    if how['jitter_s']:
        times = times + how['jitter_s'] * random.normal(size=len(times))
        times = numpy.maximum.accumulate(times - times[0] + 1e-4 * numpy.arange(len(times)))
    return times - times[0]


def take_of(setup, grid, name, fps):
    vertices, _, until = families.holds_of(setup, grid)
    return {'name': name, 'fps': fps, 'grid': dict(setup['cloth'], columns=grid[0], rows=grid[1]),
            'held': [dict({'vertex': vertex}, **({'until_s': end - BEFORE} if numpy.isfinite(end)
                                                 else {}))
                     for vertex, end in zip(vertices, until)], 'obstacles': setup.get('obstacles', [])}


def spread_of(setup, seen, noise):
    """Covariances of places that two cameras make out, [time][vertex][3][3]; noise is how far off a
    sharp one is across its ray, a metre away."""
    middle = setup['paths'][0].mean(axis=0)
    column = numpy.arange(seen.shape[1]) % setup['cloth']['columns']
    known = numpy.zeros(seen.shape + (3,))
    for camera, place in enumerate(CAMERAS):
        ray = seen - (middle + place)
        far = numpy.linalg.norm(ray, axis=2)
        ray /= far[:, :, None]
        blur = numpy.where((2 * column >= setup['cloth']['columns']) & (camera == 1), 3., 1.)
        known += (numpy.eye(3) - ray[:, :, :, None] * ray[:, :, None, :]) / (
            (noise * blur * far) ** 2)[:, :, None, None]
    return numpy.linalg.inv(known)


def film(folder, name, setup, positions, random, clock=None, change=None):
    """Records what @positions do: noise and what is hidden; the stated noise is what a rig would
    state. Of pictures at t the cloth is that of clock(t); change spoils the points."""
    how, cloth = setup['how'], setup['cloth']
    grid = cloth['columns'], cloth['rows']
    # so that jitter alone changes no other number
    times = times_of(how, numpy.random.default_rng(random.integers(2 ** 32)))
    noise = how['noise_m'] or random.uniform(3e-4, 5e-4)
    seen = families.interpolate(positions, BEFORE + (clock(times) if clock else times))
    if change:
        seen = change(seen, times)
    off, spread = random.normal(size=(4096,) + seen.shape[1:])[:len(seen)], None
    if setup['noise'] == 'even':
        seen = seen + noise * off
    else:
        spread = spread_of(setup, seen, noise)
        seen = seen + numpy.einsum('ijkl,ijl->ijk', numpy.linalg.cholesky(spread), off)
        noise = float(numpy.sqrt(numpy.einsum('ijkk->ij', spread).mean() / 3.))
    row, column = numpy.divmod(numpy.arange(grid[0] * grid[1]), grid[0])
    for _ in range(3):
        # Something passes before the cloth.
        length = random.uniform(0.12, 0.24)
        first = random.uniform(0., how['seconds'] - 0.25)
        at = random.uniform(0, (grid[1], grid[0]))
        way = random.normal(size=2) * 10.
        for frame in numpy.flatnonzero((times >= first) & (times < first + length)):
            y, x = at + way * (times[frame] - first)
            seen[frame, (row - y) ** 2 + (column - x) ** 2 < 2.5] = numpy.nan
    seen[(random.random((4096, seen.shape[1])) < 0.01)[:len(seen)]] = numpy.nan
    _, paths, _ = families.holds_of(setup, grid)
    exact = not how['jitter_s'] and not how['dropped']
    families.write_take(folder, dict(take_of(setup, grid, name, how['fps']), noise_sigma_m=noise),
                        seen, families.interpolate(paths, BEFORE + times),
                        None if exact else times,
                        spread if setup['noise'] == 'cameras' else None)
    return noise


def write_twin(folder, name, setup, positions, grid, random):
    """A simulation as it is written: no noise, nothing hidden, frame times of its own."""
    how = setup['how']
    fps = float(random.choice([how['fps'], 60., 100.]))
    times = numpy.arange(int(numpy.ceil((how['seconds'] + 0.01) * fps)) + 1) / fps
    _, paths, _ = families.holds_of(setup, grid)
    families.write_take(folder, take_of(setup, grid, name, fps),
                        families.interpolate(positions, BEFORE + times),
                        families.interpolate(paths, BEFORE + times))


def shape_outside(case, setup, random):
    """What is done to a recording alone: clock and change of film()."""
    name, size = case['outside'], case['severity']
    cloth = setup['cloth']
    grid = cloth['rows'], cloth['columns']
    way = random.normal(size=3)
    way /= numpy.linalg.norm(way)
    sign = random.choice((-1., 1.))
    clock = change = None

    def drift(seen, times):
        # The calibration drifts: the lower and the right part bulge towards the camera.
        flat = families.flat_points(setup, (grid[1], grid[0]))
        bulge = (flat[:, 2] / cloth['height_m']) ** 2 * flat[:, 0] / cloth['width_m']
        seen = seen.copy()
        seen[:, :, 1] += 1.5e-3 * size * times[:, None] * bulge
        return seen

    def smooth(seen, times):
        weight = numpy.exp(-0.5 * ((times[:, None] - times) / (0.01 * size)) ** 2)
        return numpy.einsum('ij,jkl->ikl', weight / weight.sum(axis=1, keepdims=True), seen)

    def exchange(seen, times):
        first, second = random.choice(numpy.arange(1, grid[0]), 2, replace=False)
        out = seen.reshape(len(seen), *grid, 3).copy()
        out[:, [first, second]] = out[:, [second, first]]
        return out.reshape(seen.shape)

    def turn(seen, axis, angle):
        middle = setup['paths'][0].mean(axis=0)
        x = seen - middle
        return middle + x * numpy.cos(angle) + numpy.cross(axis, x) * numpy.sin(angle) + \
            axis * (x @ axis)[..., None] * (1. - numpy.cos(angle))

    if name == 'drift':
        change = drift
    elif name == 'wobble':
        # The recorder's clock wobbles.
        clock = lambda t: t + 2e-3 * size * numpy.sin(6.2832 * 1.3 * t)
    elif name == 'scale':
        change = lambda seen, times: seen * (1. + sign * 0.006 * size)
    elif name == 'smoothed':
        change = smooth
    elif name == 'labels':
        change = exchange
    elif name == 'turned':
        change = lambda seen, times: turn(seen, way, sign * numpy.radians(4. * size))
    elif name == 'frame-rate':
        clock = lambda t: t * (1. + sign * 0.016 * size)
    elif name == 'late':
        clock = lambda t: t - 0.012 * size
    elif name == 'mirrored':
        change = lambda seen, times: seen * [1., -1., 1.] if size < 3. else seen * [-1., 1., 1.] \
            + [cloth['width_m'], 0., 0.]
    return clock, change


def strange_forces(case, setup, random):
    """What acts that the library has no name for: what the finite elements are told beside."""
    name, size, cloth = case['outside'], case['severity'], setup['cloth']
    fine = 2 * (cloth['columns'] - 1) + 1, 2 * (cloth['rows'] - 1) + 1
    seconds = setup['how']['seconds']
    where = numpy.array([random.uniform(0.2, 0.8) * fine[0], random.uniform(0.4, 0.9) * fine[1]])
    if name == 'thread':
        point = int(where[1]) * fine[0] + int(where[0])
        hook = families.flat_points(setup, fine)[point] + setup['paths'][0, 0]
        hook += random.normal(size=3) * 0.05
        return {'thread': [point, *hook, 0.05 / size, 0.3 * size]}
    if name == 'rain':
        drops = []
        for _ in range(int(10 * size)):
            drops += [BEFORE + random.uniform(0., seconds), int(random.integers(
                fine[0], fine[0] * fine[1])), 2e-4 * random.exponential()]
        return {'rain': drops}
    if name == 'creep':
        return {'creep': [0.01 * size]}
    if name == 'seam':
        first = int(random.integers(4, fine[1] - 4))
        return {'seam': [first, first + 2, 1. + 3. * size]}
    if name == 'attraction':
        return {'attraction': [0., 1., 0., 0.06 * random.choice((-1., 1.)), 0.15 * size, 0.04]}
    if name == 'wet':
        return {'wet': [*where, 4., 1. + size / 2., BEFORE + 1.2 * seconds]}
    if name == 'tape':
        return {'wet': [*where, 2.5, 1. + size, 1e9]}
    return {}


def simulate_outside(realities, family, numbers, case, setup, random):
    """Reality with something in it that the library has no name for; and the paths of the
    clamps that were."""
    name, size = case['outside'], case['severity']
    t = numpy.arange(len(setup['paths'])) / HZ - BEFORE
    on = numpy.clip(t / 0.1, 0., 1.)
    real = dict(setup, paths=setup['paths'].copy())
    if name == 'clamp-shake':
        # A clamp trembles, and the log doesn't know.
        real['paths'][:, 1, 2] += 1.5e-3 * size * on * numpy.sin(6.2832 * 4. * t)
    elif name == 'shaken-frame':
        # Clamps, cloth and cameras ride on a platform: a periodic force on all.
        ride = 1.5e-3 * size * on * numpy.sin(6.2832 * 3. * t)
        real['paths'][:, :, 1] += ride[:, None]
        positions = realities.simulate(family, real, numbers)
        positions[:, :, 1] -= ride[:, None]
        return positions
    elif name == 'obstacle':
        # A ball that the cloth swings against.
        ball = [setup['cloth']['width_m'] / 2, 0.05, -0.75 * setup['cloth']['height_m'],
                0.03 + 0.003 * size]
        return realities.simulate(family, setup, numbers, strange={'balls': [ball]})
    elif name == 'pitched':
        # World and clamps' log lean alike.
        return realities.simulate(family, setup, numbers, {'gravity_tilt': dict(zip(
            'xy', (4. * size * unit_circle(random)).tolist()))})
    elif name == 'caught':
        # The lower corner hangs on a thread that gives slowly.
        free = realities.simulate(family, setup, numbers)
        corner = free.shape[1] - 1
        path = free[:, corner].copy()
        slow = path[int(BEFORE * HZ)] + (path - path[int(BEFORE * HZ)]) * (1. - 0.1 * size)
        path = numpy.where(t[:, None] > 0., slow, path)
        return realities.simulate(family, setup, numbers,
                                  strange={'led': [(corner, path, 0.)]})
    return realities.simulate(family, real, numbers, strange=strange_forces(case, setup, random))


def unit_circle(random):
    way = random.normal(size=2)
    return way / numpy.linalg.norm(way)


def touch_with_ball(realities, family, numbers, setup, free, size, random):
    """A ball in the way of a vertex, where it comes first at a time by chance."""
    radius = 0.04 + 0.002 * size
    columns, rows = setup['cloth']['columns'], setup['cloth']['rows']
    begin = int(BEFORE * HZ)
    for _ in range(200):
        first = begin + int(random.integers(0.4 * HZ, HZ))
        vertex = int(random.integers(3 * columns, rows * columns))
        way = free[first + 1, vertex] - free[first - 1, vertex]
        speed = numpy.linalg.norm(way) * HZ / 2.
        centre = free[first, vertex] + way / max(numpy.linalg.norm(way), 1e-9) * radius
        apart = numpy.linalg.norm(free - centre, axis=2)
        if speed > 0.1 and apart[:first].min() > radius + 1e-3:
            real = realities.simulate(family, setup, numbers,
                                      strange={'balls': [[*centre, radius]]})
            apart = numpy.linalg.norm(real[begin:] - centre, axis=2).min(axis=0)
            return real, numpy.flatnonzero(apart < radius + 2e-3)
    raise families.CannotSimulate('the cloth is too slow to touch a ball')


def lead_with_finger(realities, family, numbers, setup, free, size, random):
    """A patch that is taken hold of, and led off the way it would go."""
    begin = int(BEFORE * HZ)
    columns, rows = setup['cloth']['columns'], setup['cloth']['rows']
    first = begin + int(random.integers(0.4 * HZ, HZ))
    high, wide = random.integers(2, 5, 2)
    row, column = random.integers(2, rows - high + 1), random.integers(0, columns - wide + 1)
    patch = ((row + numpy.arange(high))[:, None] * columns + column + numpy.arange(wide)).ravel()
    way = random.normal(size=3) * (0.3, 1., 0.3)
    on = numpy.clip((numpy.arange(len(free)) - first) / (0.2 * HZ), 0., 1.)
    on = on ** 2 * (3. - 2. * on)
    path = free[:, patch] + 0.003 * size * on[:, None, None] * way / numpy.linalg.norm(way)
    real = realities.simulate(family, setup, numbers, strange={
        'led': [(int(vertex), path[:, k], first / HZ) for k, vertex in enumerate(patch)]})
    return real, patch


def act_locally(realities, case, numbers, setup, free, random):
    """The cloth with a local case, and where its force acts (None: no place of its own)."""
    family, size = case['family'], case['severity']
    if case['outside'] == 'ball':
        return touch_with_ball(realities, family, numbers, setup, free, size, random)
    if case['outside'] == 'finger':
        return lead_with_finger(realities, family, numbers, setup, free, size, random)
    real = realities.simulate(family, setup, numbers, case['effects'])
    if case['outside'] == 'slip':
        return real, None
    # Vertices that stand for more of the hem than of what is above it.
    height, cloth = case['effects']['mass_distribution']['height'], setup['cloth']
    row = numpy.arange(free.shape[1]) // cloth['columns']
    above = (cloth['rows'] - 1.5 - row) * cloth['height_m'] / (cloth['rows'] - 1)
    return real, numpy.flatnonzero(above < height)


def add_evidence(realities, evidence, folder, name, case, numbers, setup, quiet, random):
    """Writes what is given beside a take to a folder; twins are of what didn't act."""
    family, cloth = case['family'], setup['cloth']
    grid = cloth['columns'], cloth['rows']
    if evidence in ('twin', 'cousin'):
        if evidence == 'cousin':
            others = [other for other in tuple(OWN) + OUTSIDE
                      if other != family and realities.has(other)]
            kin = bool(random.integers(2))
            family = family if kin else str(random.choice(others))
            numbers = families.draw_numbers(random) if kin else MODEL
        finer = random.integers(2)
        if finer:
            grid = grid[0] + 2, grid[1] + 1
        made = quiet if evidence == 'twin' and not finer else \
            realities.simulate(family, setup, numbers, grid=grid)
        write_twin(folder, name, setup, made, grid, random)
        return {'twin_family': family, 'twin_mesh': 'other' if finer else 'same'}
    motion = setup['motion']
    if evidence == 'other':
        # A stranger moves in another way, too.
        kind = motion['name'] if case['stranger'] is None else 'sway'
        motion = choose_motion(kind, random)
    setup = move(dict(setup, motion=motion, until_s={}, bulge_m=0.), random)
    film(folder, name, setup, realities.simulate(family, setup, numbers), random)
    return {}


def root_mean_square(change):
    return float(numpy.sqrt((change ** 2).sum(axis=2).mean()))


def effects_in_take(effects):
    """Effects as a model has them that starts when the recording does, not before."""
    effects = copy.deepcopy(effects)
    if 'clamp_slip' in effects:
        effects['clamp_slip']['time'] -= BEFORE
    return effects


def record(realities, case, folder, name, seed, every=False, noise='even'):
    """Records a case and what is given beside it (every: all that could be), with one of NOISES;
    returns what the label needs beyond the case."""
    random = numpy.random.default_rng([seed, case['draw']])
    numbers = families.draw_numbers(random)
    setup = move(dict(choose_setup(case, random), noise=noise), random)
    family = case['family']
    quiet = realities.simulate(family, setup, numbers)
    region, clock, change = None, None, None
    if case['kind'] == 'local':
        real, region = act_locally(realities, case, numbers, setup, quiet, random)
    elif case['outside']:
        real = simulate_outside(realities, family, numbers, case, setup, random)
        clock, change = shape_outside(case, setup, random)
    elif case['effects']:
        real = realities.simulate(family, setup, numbers, case['effects'])
    elif case.get('bulge_m'):
        real = realities.simulate(family, dict(setup, bulge_m=case['bulge_m']), numbers)
    else:
        real = quiet
    noise = film(os.path.join(folder, 'take'), name, setup, real, random, clock, change)
    label = {'noise_m': noise, 'region': None if region is None else [int(k) for k in region],
             'fps': setup['how']['fps'], 'family_is': 'own' if family in OWN else 'outside'}
    times = numpy.arange(0., setup['how']['seconds'], 1. / setup['how']['fps'])
    before = families.interpolate(quiet, BEFORE + times)
    after = families.interpolate(real, BEFORE + (clock(times) if clock else times))
    moved = (change(after, times) if change else after) - before
    if case['kind'] == 'pair':
        # How far the weaker one of the two moves the cloth beyond the other.
        label['second_m'] = min(root_mean_square(real - realities.simulate(
            family, setup, numbers, {name: case['effects'][name]})) for name in case['effects'])
    # What begins later leaves the cloth as it was until then, to the last bit but one.
    begun = numpy.flatnonzero(numpy.abs(moved).max(axis=(1, 2)) > 1e-5)
    label['size_m'] = root_mean_square(moved)
    label['onset_s'] = float(times[begun[0]]) if len(begun) and begun[0] else None
    given = {'twin': 'twin', 'cousin': 'cousin', 'same': 'baseline_same',
             'other': 'baseline_other'} if every else \
        {case['evidence']: 'simulated' if case['evidence'] in ('twin', 'cousin') else 'baseline'}
    for evidence, beside in given.items():
        if evidence != 'none':
            label.update(add_evidence(
                realities, evidence, os.path.join(folder, beside), '%s-%s' % (name, beside.replace(
                    '_', '-')), case, numbers, setup, quiet, random))
    return label
