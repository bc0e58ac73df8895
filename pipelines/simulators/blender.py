#!/usr/bin/python3
"""Blender's cloth behind the contract of docs/own-simulator.md (Blender 3.4).

  gst-cloth-gap-1.0 check-simulator pipelines/simulators/blender.py --scene TAKE

The file runs twice: by Python, as the command that is asked, and inside of Blender, which
simulates. The environment variable BLENDER names another program than `blender`.

What Blender does with time: a frame of its cloth is sqrt(0.001) s of physics whatever the rate
of the scene, as its gravity is taken in thousandths (source/blender/blenkernel/intern/cloth.c,
simulation/intern/SIM_mass_spring.cpp). So the time scale of the modifier is set to the time
between two frames over sqrt(0.001) s; with Blender's own value, 1, cloth at 50 frames/s falls
with 2.5 times gravity.

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import json
import math
import os
import shutil
import subprocess
import sys

FRAME_S = math.sqrt(0.001)
# name, unit, value, range, what it is in a model.json, that over this, what it means
PARAMETERS = [
    ('mass', 'kg', 0.3, [0.03, 3], 'areal_density', None, 'Vertex Mass'),
    ('tension_stiffness', '1', 15, [0.5, 500], ['stretch.warp', 'stretch.weft'], None,
     'Stiffness, Tension'),
    ('compression_stiffness', '1', 15, None, None, None, 'Stiffness, Compression'),
    ('shear_stiffness', '1', 5, [0.05, 500], 'shear', None, 'Stiffness, Shear'),
    ('bending_stiffness', '1', 0.5, [0.005, 50], ['bending.warp', 'bending.weft'], None,
     'Stiffness, Bending'),
    ('tension_damping', '1', 5, [0.05, 50], 'damping.stiffness', None, 'Damping, Tension'),
    ('compression_damping', '1', 5, None, None, None, 'Damping, Compression'),
    ('shear_damping', '1', 5, None, None, None, 'Damping, Shear'),
    ('bending_damping', '1', 0.5, None, None, None, 'Damping, Bending'),
    ('air_damping', '1', 1, [0, 10], ['damping.mass', 'effects.air_drag_linear.coefficient'],
     None, 'Air Viscosity'),
    ('wind_x', '1', 0, [-5000, 5000], 'effects.wind.x', None, 'Strength of a wind field along x'),
    ('wind_y', '1', 0, [-5000, 5000], 'effects.wind.y', None, 'Strength of a wind field along y'),
    ('wind_z', '1', 0, [-5000, 5000], 'effects.wind.z', None, 'Strength of a wind field along z'),
    ('gravity', '1', 1, [0, 4], 'effects.gravity_scale.factor', 1, 'Field Weights, Gravity'),
    ('gravity_x', 'm/s²', 0, [-5, 5], 'effects.gravity_tilt.x', 5.84, 'Gravity along x, more'),
    ('gravity_y', 'm/s²', 0, [-5, 5], 'effects.gravity_tilt.y', 5.84, 'Gravity along y, more'),
    ('shrink_min', '1', 0, [-0.2, 0.2], ['effects.shrinkage.warp', 'effects.shrinkage.weft'], 1,
     'Shape, Shrinking Factor'),
    ('time_scale', '1', 1, None, None, None, 'Speed Multiplier; 1 is real time here'),
    ('quality', '1', 12, None, None, None, 'Quality Steps of a frame'),
    ('collision_quality', '1', 4, None, None, None, 'Quality of collisions'),
    ('distance_min', 'm', 0.005, None, None, None, 'Distance of collisions'),
]


# ---- the command ----

def print_capabilities(program):
    said = subprocess.run([program, '--version'], capture_output=True, text=True, check=True)
    keys = ('name', 'unit', 'value', 'range', 'is', 'scale', 'blurb')
    json.dump({'version': 1, 'simulator': 'Blender cloth',
               'simulator_version': said.stdout.split()[1],
               'parameters': [dict(zip(keys, row)) for row in PARAMETERS]}, sys.stdout)


def command(argument):
    program = os.environ.get('BLENDER', 'blender')
    if not shutil.which(program):
        sys.exit('there is no program “%s”: install Blender or set BLENDER' % program)
    if argument == '--capabilities':
        print_capabilities(program)
        return
    sys.exit(subprocess.run(
        [program, '-b', '--factory-startup', '--python-exit-code', '1', '--python',
         os.path.abspath(__file__), '--', argument], check=False).returncode)


# ---- inside of Blender ----

def read_mesh(folder, take):
    """Vertices on the flat cloth in metres and faces."""
    if 'grid' in take:
        grid = take['grid']
        columns, rows = grid['columns'], grid['rows']
        uv = [(c * grid['width_m'] / (columns - 1), r * grid['height_m'] / (rows - 1))
              for r in range(rows) for c in range(columns)]
        faces = [(r * columns + c, (r + 1) * columns + c, (r + 1) * columns + c + 1,
                  r * columns + c + 1) for r in range(rows - 1) for c in range(columns - 1)]
        return uv, faces
    # Vertex i of the take is the i-th of the file; faces name a vertex and its uv.
    n, texture, faces, uv = 0, [], [], {}
    with open(os.path.join(folder, take['mesh']), encoding='utf-8') as file:
        for line in file:
            words = line.split()
            if words[:1] == ['v']:
                n += 1
            elif words[:1] == ['vt']:
                texture.append((float(words[1]), float(words[2])))
            elif words[:1] == ['f']:
                corners = [[int(k) - 1 if k else 0 for k in word.split('/')] for word in words[1:]]
                faces.append(tuple(corner[0] for corner in corners))
                uv.update({corner[0]: texture[corner[1]] for corner in corners})
    return [uv.get(i, (0., 0.)) for i in range(n)], faces


def keyframe(block, path, index, values):
    """A value a frame, linear between frames."""
    import numpy
    data = block.animation_data or block.animation_data_create()
    if not data.action:
        import bpy
        data.action = bpy.data.actions.new('paths')
    curve = data.action.fcurves.new(path, index=index)
    curve.keyframe_points.add(len(values))
    frames = numpy.arange(1, len(values) + 1, dtype=float)
    curve.keyframe_points.foreach_set('co', numpy.stack([frames, values], axis=1).ravel())
    curve.keyframe_points.foreach_set('interpolation', [1] * len(values))
    curve.update()


def add_sphere(bpy, obstacle):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=obstacle['radius_m'],
                                         location=obstacle['centre'])


def add_plane(bpy, obstacle):
    import mathutils
    bpy.ops.mesh.primitive_plane_add(size=20., location=obstacle['point'])
    bpy.context.object.rotation_mode = 'QUATERNION'
    bpy.context.object.rotation_quaternion = mathutils.Vector(
        (0., 0., 1.)).rotation_difference(mathutils.Vector(obstacle['normal']))


def add_obstacles(bpy, take, p):
    kinds = {'sphere': add_sphere, 'plane': add_plane}
    for obstacle in take.get('obstacles', []):
        if obstacle['type'] not in kinds:
            sys.exit('blender.py knows spheres and planes as obstacles, not “%s”' %
                     obstacle['type'])
        kinds[obstacle['type']](bpy, obstacle)
        bpy.context.object.modifiers.new('collision', 'COLLISION')
        bpy.context.object.collision.thickness_outer = 0.001
        # Blender's friction is in hundredths and goes to 80.
        bpy.context.object.collision.cloth_friction = min(
            80., 100. * (obstacle.get('friction') or 0.))


def add_wind(bpy, p):
    import mathutils
    wind = mathutils.Vector((p['wind_x'], p['wind_y'], p['wind_z']))
    if wind.length == 0.:
        return
    bpy.ops.object.effector_add(type='WIND', rotation=mathutils.Vector(
        (0., 0., 1.)).rotation_difference(wind).to_euler())
    field = bpy.context.object.field
    field.strength, field.flow, field.noise = wind.length, 0., 0.


def find_time_scale(dt, quality):
    """dt in frames of Blender. Its solver adds up quality steps of a quality-th of the scale in
    single precision while the sum is below the scale, so rounding may make it take one more
    step: time goes by 1/quality too fast. A scale next to the wanted one does not."""
    import numpy
    scale = numpy.float32(dt / FRAME_S)
    while True:
        step, now, n = numpy.float32(1. / quality) * scale, numpy.float32(0.), 0
        while now < scale:
            now, n = now + step, n + 1
        if n == quality:
            return float(scale)
        scale = numpy.nextafter(scale, numpy.float32(0.))


def set_cloth(cloth, p, dt, n_frames):
    settings = cloth.settings
    for name in ('mass', 'tension_stiffness', 'compression_stiffness', 'shear_stiffness',
                 'bending_stiffness', 'tension_damping', 'compression_damping', 'shear_damping',
                 'bending_damping', 'air_damping', 'shrink_min'):
        setattr(settings, name, p[name])
    settings.quality = int(p['quality'])
    settings.time_scale = find_time_scale(p['time_scale'] * dt, settings.quality)
    settings.effector_weights.gravity = p['gravity']
    cloth.collision_settings.collision_quality = int(p['collision_quality'])
    cloth.collision_settings.distance_min = p['distance_min']
    cloth.point_cache.frame_start, cloth.point_cache.frame_end = 1, n_frames


def pin(ob, take, times, clamps, start):
    """Blender's cloth pulls pinned vertices to where the mesh below the modifier has them, so
    that mesh moves: three shape keys for each held vertex."""
    import numpy
    group = ob.vertex_groups.new(name='pin')
    ob.shape_key_add(name='Basis')
    for k, held in enumerate(take.get('held', [])):
        vertex, path = held['vertex'], clamps[:, k]
        on = (times >= held.get('from_s', -math.inf)) & (times < held.get('until_s', math.inf))
        if not on.all():
            sys.exit('blender.py can’t let go of a clamp: leave takes with from_s or until_s out')
        group.add([vertex], 1., 'REPLACE')
        for axis in range(3):
            key = ob.shape_key_add(name='%d %d' % (k, axis))
            key.slider_min, key.slider_max = -10., 10.
            # A tenth of a metre each, so that sliders stay within their limits.
            at = start[vertex].copy()
            at[axis] += 0.1
            key.data[vertex].co = at
            values = (path[:, axis] - start[vertex, axis]) / 0.1
            keyframe(ob.data.shape_keys, 'key_blocks["%s"].value' % key.name, -1,
                     numpy.clip(values, -10., 10.))
            if numpy.abs(values).max() > 10.:
                sys.exit('blender.py: a clamp goes further than a metre')


def simulate(folder):
    import bpy
    import numpy
    scene_folder = os.path.join(folder, 'scene')
    with open(os.path.join(scene_folder, 'take.json'), encoding='utf-8') as file:
        take = json.load(file)
    with open(os.path.join(folder, 'parameters.json'), encoding='utf-8') as file:
        p = dict({row[0]: row[2] for row in PARAMETERS}, **json.load(file))
    start = numpy.load(os.path.join(scene_folder, 'positions.npy'))[0].astype(float)
    asked = numpy.load(os.path.join(scene_folder, 'times.npy'))
    clamps = numpy.zeros((len(asked), 0, 3))
    if take.get('held'):
        clamps = numpy.load(os.path.join(scene_folder, 'clamps.npy')).astype(float)

    # Blender's frames are equally long: the scene's times are interpolated from them.
    n_frames = len(asked)
    times = numpy.linspace(asked[0], asked[-1], n_frames)
    flat_clamps = clamps.reshape(n_frames, -1)
    clamps = numpy.stack([numpy.interp(times, asked, column) for column in flat_clamps.T],
                         axis=1).reshape(clamps.shape) if flat_clamps.size else clamps

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, n_frames
    gravity = take.get('gravity', [0., 0., -9.81])
    scene.gravity = (gravity[0] + p['gravity_x'], gravity[1] + p['gravity_y'], gravity[2])
    uv, faces = read_mesh(scene_folder, take)
    add_obstacles(bpy, take, p)
    add_wind(bpy, p)

    # Springs are as long as in the mesh of the rest shape: the flat cloth.
    mesh = bpy.data.meshes.new('cloth')
    mesh.from_pydata([tuple(v) for v in start], [], faces)
    ob = bpy.data.objects.new('cloth', mesh)
    scene.collection.objects.link(ob)
    pin(ob, take, times, clamps, start)
    flat = ob.shape_key_add(name='flat')
    for i, (u, v) in enumerate(uv):
        flat.data[i].co = (u, 0., -v)
    flat.value = 0.
    cloth = ob.modifiers.new('cloth', 'CLOTH')
    set_cloth(cloth, p, times[1] - times[0], n_frames)
    cloth.settings.vertex_group_mass = 'pin'
    cloth.settings.pin_stiffness = 1.
    cloth.settings.rest_shape_key = flat

    positions = numpy.empty((n_frames, len(start), 3), numpy.float32)
    for frame in range(n_frames):
        scene.frame_set(frame + 1)
        evaluated = ob.evaluated_get(bpy.context.evaluated_depsgraph_get())
        places = numpy.empty(3 * len(start), numpy.float32)
        evaluated.data.vertices.foreach_get('co', places)
        positions[frame] = places.reshape(-1, 3)
    flat_positions = positions.reshape(n_frames, -1)
    if numpy.abs(times - asked).max() > 1e-6:
        positions = numpy.stack([numpy.interp(asked, times, column) for column in
                                 flat_positions.T], axis=1).reshape(positions.shape)
    out = os.path.join(folder, 'simulated')
    os.makedirs(out, exist_ok=True)
    for name in os.listdir(scene_folder):
        if name not in ('positions.npy', 'states.npy'):
            shutil.copy(os.path.join(scene_folder, name), out)
    numpy.save(os.path.join(out, 'positions.npy'), positions.astype(numpy.float32))


if '--' in sys.argv:
    simulate(sys.argv[sys.argv.index('--') + 1])
else:
    command(sys.argv[1])
