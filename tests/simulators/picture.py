"""Draws recorded, before and after of what reality.py has left, each coloured by its distance from
what was recorded. Blender runs it:

  blender -b --factory-startup --python picture.py -- FOLDER OUTPUT.png CASE…

SPDX-License-Identifier: LGPL-2.1-or-later
"""
import os
import sys

import bpy
import numpy

folder, output, *cases = sys.argv[sys.argv.index('--') + 1:]
WIDE, HIGH = 0.62, 0.6
# From no distance to LIMIT, m: paper, amber, red.
LIMIT = 0.03
COLOURS = numpy.array([[0.45, 0.5, 0.57], [0.93, 0.55, 0.1], [0.6, 0.02, 0.05]])


def find_colours(distance):
    at = numpy.clip(distance / LIMIT, 0., 1.) * (len(COLOURS) - 1)
    low = numpy.minimum(at.astype(int), len(COLOURS) - 2)
    share = (at - low)[:, None]
    return (1. - share) * COLOURS[low] + share * COLOURS[low + 1]


def add_text(text, x, z, size, align='CENTER'):
    curve = bpy.data.curves.new('text', 'FONT')
    curve.body, curve.size, curve.align_x = text, size, align
    ob = bpy.data.objects.new('text', curve)
    ob.location, ob.rotation_euler = (x, -2., z), (numpy.pi / 2., 0., 0.)
    material = bpy.data.materials.new('ink')
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    light = nodes.new('ShaderNodeEmission')
    light.inputs['Color'].default_value = (0.012, 0.017, 0.026, 1.)
    end = nodes.new('ShaderNodeOutputMaterial')
    material.node_tree.links.new(light.outputs[0], end.inputs[0])
    curve.materials.append(material)
    bpy.context.scene.collection.objects.link(ob)


def add_cloth(x, distance, at):
    n = int(round(numpy.sqrt(len(x))))
    index = numpy.arange(n * n).reshape(n, n)
    faces = numpy.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]],
                        axis=-1).reshape(-1, 4)
    # seen from the side, so that what is before and behind shows
    turned = x @ numpy.array([[0.8, 0.6, 0.], [-0.6, 0.8, 0.], [0., 0., 1.]]).T
    mesh = bpy.data.meshes.new('cloth')
    mesh.from_pydata((turned + [at[0] - 0.11, 0., at[1]]).tolist(), [], faces.tolist())
    for polygon in mesh.polygons:
        polygon.use_smooth = True
    layer = mesh.attributes.new('colour', 'FLOAT_COLOR', 'POINT')
    colours = numpy.concatenate([find_colours(distance), numpy.ones((len(x), 1))], axis=1)
    layer.data.foreach_set('color', colours.ravel())
    material = bpy.data.materials.new('cloth')
    material.use_nodes = True
    shader = material.node_tree.nodes['Principled BSDF']
    shader.inputs['Roughness'].default_value = 0.9
    shader.inputs['Specular'].default_value = 0.1
    colour = material.node_tree.nodes.new('ShaderNodeVertexColor')
    colour.layer_name = 'colour'
    material.node_tree.links.new(colour.outputs[0], shader.inputs['Base Color'])
    mesh.materials.append(material)
    ob = bpy.data.objects.new('cloth', mesh)
    ob.modifiers.new('finer', 'SUBSURF').render_levels = 2
    bpy.context.scene.collection.objects.link(ob)


bpy.ops.wm.read_factory_settings(use_empty=True)
for row, case in enumerate(cases):
    takes = [numpy.load(os.path.join(folder, case, name + '.npy')).astype(float)
             for name in ('recorded', 'before', 'after')]
    apart = [numpy.linalg.norm(take - takes[0], axis=2) for take in takes]
    frame = int((apart[1] ** 2).mean(axis=1).argmax())
    with open(os.path.join(folder, case, 'title.txt'), encoding='utf-8') as file:
        add_text(file.read(), -0.28, -row * HIGH + 0.115, 0.026, 'LEFT')
    for column, (take, distance) in enumerate(zip(takes, apart)):
        add_cloth(take[frame], distance[frame], (column * WIDE, -row * HIGH))
        rms = 1e3 * numpy.sqrt((distance[1:] ** 2).mean())
        add_text(('recorded', 'before: %.1f mm off' % rms, 'after: %.1f mm off' % rms)[column],
                 column * WIDE, -row * HIGH + 0.06, 0.026)

scene = bpy.context.scene
world = bpy.data.worlds.new('paper')
scene.world = world
world.use_nodes = True
world.node_tree.nodes['Background'].inputs[0].default_value = (1., 1., 1., 1.)
# Paper is seen and lights nothing; suns are points, so that nothing is grainy, and cast no shadows.
world.cycles_visibility.diffuse = world.cycles_visibility.glossy = False
for energy, direction in (2.2, (1.1, 0.5, 0.5)), (1.2, (1.2, 0., -0.9)):
    sun = bpy.data.objects.new('sun', bpy.data.lights.new('sun', 'SUN'))
    sun.data.energy, sun.data.angle, sun.rotation_euler = energy, 0., direction
    sun.data.cycles.cast_shadow = False
    scene.collection.objects.link(sun)
camera = bpy.data.objects.new('camera', bpy.data.cameras.new('camera'))
camera.data.type, camera.data.ortho_scale = 'ORTHO', 3. * WIDE
camera.location = (WIDE, -5., -0.5 * HIGH * len(cases) + 0.16)
camera.rotation_euler = (numpy.pi / 2., 0., 0.)
scene.collection.objects.link(camera)
scene.camera = camera
scene.render.engine = 'CYCLES'
scene.cycles.samples, scene.cycles.max_bounces = 16, 0
scene.cycles.use_denoising = False
scene.view_settings.view_transform = 'Standard'
scene.render.resolution_x = 900
scene.render.resolution_y = int(900 * HIGH * len(cases) / (3. * WIDE))
scene.render.image_settings.color_mode, scene.render.image_settings.compression = 'RGB', 100
scene.render.filepath = os.path.abspath(output)
bpy.ops.render.render(write_still=True)
