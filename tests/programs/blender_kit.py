"""What small scenes of one feature are made of, and the lists of them: those that are rendered, and those that are named."""

import math
import os

import bpy
import numpy
from blender_scene import WORK

SIZE = (48, 32)
SHOWN = {}    # scenes by name
NAMED = {}    # and those that are named instead, with the words


def shows(make):
    SHOWN[make.__name__] = make
    return make


def names(words):
    def keep(make):
        NAMED[make.__name__] = make, words
        return make
    return keep


def link(name, data):
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def plane(material, size=4, name="plane"):
    """With a UV map."""
    mesh = bpy.data.meshes.new(name)
    s = size / 2
    mesh.from_pydata([(-s, -s, 0), (s, -s, 0), (s, s, 0), (-s, s, 0)], [], [(0, 1, 2, 3)])
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", [0, 0, 1, 0, 1, 1, 0, 1])
    if material is not None:
        mesh.materials.append(material)
    return link(name, mesh)


def cube(material, name="cube"):
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (0, 2)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], sides)
    mesh.materials.append(material)
    return link(name, mesh)


def diffuse(colour=(0.8, 0.8, 0.8)):
    """A material, and its tree and shader."""
    material = bpy.data.materials.new("diffuse")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (*colour, 1)
    tree.links.new(shader.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material, tree, shader


def principled(**values):
    material = bpy.data.materials.new("principled")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    for name, value in values.items():
        shader.inputs[name.replace("_", " ")].default_value = value
    return material, material.node_tree, shader


def image(texels, space="sRGB", **settings):
    """Of rows from the bottom, saved as PNG."""
    texels = numpy.array(texels, numpy.float32)
    height, width = texels.shape[:2]
    made = bpy.data.images.new("image", width, height, alpha=True)
    made.pixels.foreach_set(texels.ravel())
    made.filepath_raw, made.file_format = os.path.join(WORK, "image%d.png" % len(os.listdir(WORK))), "PNG"
    made.save()
    path = made.filepath_raw
    bpy.data.images.remove(made)
    made = bpy.data.images.load(path)
    made.colorspace_settings.name = space
    for name, value in settings.items():
        setattr(made, name, value)
    return made


def checks(alpha=1.0):
    """Four colours."""
    return [[(1, 0, 0, alpha), (0, 1, 0, 1)], [(0, 0, 1, 1), (1, 1, 0.2, alpha)]]


def textured(texels=None, space="sRGB", **settings):
    """A plane with an image for its colour."""
    material, tree, shader = diffuse()
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image(checks() if texels is None else texels, space)
    for name, value in settings.items():
        setattr(node, name, value)
    tree.links.new(node.outputs["Color"], shader.inputs["Color"])
    return plane(material), tree, node


def start():
    """A camera that looks down at the origin, under a white sky."""
    for kind in (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.images, bpy.data.worlds, bpy.data.node_groups,
                 bpy.data.collections):
        for item in list(kind):
            kind.remove(item)
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.background_set = None
    layer.use_sky, scene.render.use_motion_blur, scene.cycles.film_exposure = True, False, 1
    scene.cycles.use_fast_gi = False
    scene.frame_start, scene.frame_end = 1, 3
    scene.frame_set(1)
    camera = link("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0, -5, 4), (math.radians(51), 0, 0)
    scene.camera = camera
    world = scene.world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = *SIZE, 100
    render.pixel_aspect_x = render.pixel_aspect_y = 1
    render.film_transparent = True
    render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    render.image_settings.color_depth, render.image_settings.exr_codec = "32", "NONE"
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.use_adaptive_sampling, cycles.use_denoising = 512, 2, False, False
    settings = scene.shadowcache
    settings.cache_folder = os.path.join(WORK, "cache")
    settings.camera_rays, settings.samples, settings.bounces, settings.bake_spacing = 24, 4, 2, 2


def placed(node, tree, output="UV", **settings):
    mapping, where = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
    mapping.vector_type = settings.pop("kind", "POINT")
    for name, value in settings.items():
        mapping.inputs[name].default_value = value
    tree.links.new(where.outputs[output], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])


def world_node(kind):
    tree = bpy.context.scene.world.node_tree
    return tree, tree.nodes.new(kind), tree.nodes["Background"]
