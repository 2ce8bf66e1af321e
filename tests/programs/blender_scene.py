"""A small scene for tests of the render engine in a real Blender, and how pictures are told apart.

Blender is started with -- ZIP PROGRAMS MAP WORK.
"""

import math
import os
import sys

import bpy
import numpy

ZIP, PROGRAMS, MAP, WORK = sys.argv[sys.argv.index("--") + 1:]
SIZE = 64, 36
TILE = 4
DIM = 1e-3  # emission that lights nothing: Cycles samples emitters also without bounces


def install():
    """Through Blender's own operator; registered twice."""
    bpy.ops.preferences.addon_install(filepath=ZIP)
    for _ in range(2):
        bpy.ops.preferences.addon_enable(module="shadowcache")
        assert "SHADOWCACHE" in {kind.bl_idname for kind in bpy.types.RenderEngine.__subclasses__()}
        bpy.ops.preferences.addon_disable(module="shadowcache")
        assert not hasattr(bpy.types.Scene, "shadowcache")
    bpy.ops.preferences.addon_enable(module="shadowcache")
    preferences().folder = PROGRAMS


def preferences():
    return bpy.context.preferences.addons["shadowcache"].preferences


def add_material(thing, colour, emission=0):
    material = bpy.data.materials.new(thing.name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader = tree.nodes.new("ShaderNodeEmission" if emission else "ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (*colour, 1)
    if emission:
        shader.inputs["Strength"].default_value = emission
    tree.links.new(shader.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    thing.data.materials.append(material)


def make_scene():
    """Boxes on a plane; the sky is behind them, and above."""
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    bpy.ops.mesh.primitive_plane_add(size=8)
    add_material(bpy.context.object, (0.7, 0.6, 0.5))
    for i in range(4):
        bpy.ops.mesh.primitive_cube_add(size=1, location=(1.5 * i - 2.2, 0.6 * (i % 2), 0.5 + 0.3 * i))
        thing = bpy.context.object
        thing.scale.z = 1 + 0.6 * i
        add_material(thing, (0.3 + 0.2 * i, 0.5, 0.9 - 0.2 * i), DIM if i == 0 else 0)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.5, -7, 3), (math.radians(72), 0, math.radians(4))
    scene = bpy.context.scene
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.frame_end = 3
    render = scene.render
    render.resolution_x, render.resolution_y = SIZE
    render.resolution_percentage = 100
    render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    render.image_settings.color_depth, render.image_settings.exr_codec = "32", "NONE"
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.use_adaptive_sampling, cycles.use_denoising = 512, 0, False, False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = 0
    settings = scene.shadowcache
    settings.cache_folder = os.path.join(WORK, "cache")
    settings.camera_rays, settings.samples, settings.bounces, settings.bake_spacing = 64, 4, 0, 0.5


def make_world(turn=None, kind="POINT", scale=(1, 1, 1), strength=1, tint=None, image=MAP):
    """The nodes of the scene's world, made anew: an Environment Texture, with a Mapping if `turn` is given."""
    world = bpy.context.scene.world
    world.use_nodes = True
    world.cycles.sampling_method, world.cycles.sample_map_resolution = "MANUAL", 2048  # fast to build
    tree = world.node_tree
    tree.nodes.clear()
    background = tree.nodes.new("ShaderNodeBackground")
    background.inputs["Strength"].default_value = strength
    tree.links.new(background.outputs[0], tree.nodes.new("ShaderNodeOutputWorld").inputs["Surface"])
    if image is None:
        background.inputs["Color"].default_value = (*tint, 1)
        return
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(image, check_existing=True)
    colour = texture.outputs["Color"]
    if tint:
        mix = tree.nodes.new("ShaderNodeMixRGB")
        mix.blend_type = "MULTIPLY"
        mix.inputs[0].default_value, mix.inputs[2].default_value = 1, (*tint, 1)
        tree.links.new(colour, mix.inputs[1])
        colour = mix.outputs[0]
    tree.links.new(colour, background.inputs["Color"])
    if turn:
        mapping = tree.nodes.new("ShaderNodeMapping")
        mapping.vector_type = kind
        mapping.inputs["Rotation"].default_value = [math.radians(a) for a in turn]
        mapping.inputs["Scale"].default_value = scale
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])


def tiles(stack):
    height, width = stack.shape[1] // TILE, stack.shape[2] // TILE
    return stack.reshape(len(stack), height, TILE, width, TILE).mean(axis=(2, 4))


def apart(found, wanted):
    """Of two pictures: how far their means are apart, and their tiles, as shares of the mean."""
    a, b = tiles(found), tiles(wanted)
    means = abs(a.mean(axis=(1, 2)) / b.mean(axis=(1, 2)) - 1).max()
    return means, math.sqrt(((a - b) ** 2).mean()) / b.mean()


def error_of(action):
    try:
        action()
    except RuntimeError as error:
        return str(error)
    raise AssertionError("no error")


def children():
    found = []
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open("/proc/%s/stat" % name, encoding="ascii", errors="replace") as file:
                rest = file.read().rsplit(") ", 1)[1].split()
        except OSError:
            continue
        if int(rest[1]) == os.getpid() and rest[0] != "Z":
            found.append(int(name))
    return found
