"""More scenes of blender_scenes_cases.py: what was found beside Cycles by walking kinds of objects, images and frames."""

import os
import sys

import bpy
import numpy
from blender_kit import cube, diffuse, image, link, names, plane, shows, textured
from blender_scene import WORK


def scene():
    return bpy.context.scene


# Frames in which no motion is recorded.

def moving(last, frame, subframe=0.0):
    """A cube on its way from frame 1 to frame `last`."""
    plane(diffuse()[0], 6)
    thing = cube(diffuse((0.3, 0.5, 0.7))[0])
    for at, x in ((1, -1.5), (last, 1.5)):
        thing.location.x = x
        thing.keyframe_insert("location", frame=at)
    scene().frame_set(frame, subframe=subframe)


@shows
def between_frames():
    moving(3, 1, 0.5)


@shows
def after_the_last_frame():
    moving(20, 15)


@shows
def before_the_first_frame():
    moving(20, 5)
    scene().frame_start, scene().frame_end = 18, 20


# What has nothing to show, or not in each frame.

def in_the_sky():
    """The world is seen."""
    scene().render.film_transparent = False
    scene().world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.5, 0.9, 1)


@shows
def the_world_alone():
    in_the_sky()


@shows
def edges_alone():
    in_the_sky()
    mesh = bpy.data.meshes.new("edges")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0)], [(0, 1)], [])
    link("edges", mesh)


@shows
def a_scale_of_nothing():
    in_the_sky()
    cube(diffuse()[0]).scale = (0, 0, 0)


def growing(frame):
    in_the_sky()
    thing = cube(diffuse((0.9, 0.3, 0.1))[0])
    for at, size in ((1, 0), (3, 1)):
        thing.scale = (size, size, size)
        thing.keyframe_insert("scale", frame=at)
    scene().frame_set(frame)


@shows
def before_it_grows():
    growing(1)


@shows
def while_it_grows():
    growing(2)


# Images.

@shows
def dark_bytes_alone():
    """Bytes times their opacity are bytes again, in Cycles."""
    textured([[(0.1 + 0.02 * i, 0.2, 0.15, 0.5)] * 4 for i in range(4)], interpolation="Closest")


@shows
def cubic_extended():
    _, _, node = textured(interpolation="Cubic", extension="EXTEND")
    bpy.data.objects["plane"].data.uv_layers[0].data.foreach_set("uv", [-0.6, -0.4, 1.7, -0.4, 1.7, 1.5, -0.6, 1.5])


@shows
def floats_of_blender():
    """Floats that are generated are filtered as they are, whatever their colour space."""
    made = bpy.data.images.new("floats", 8, 8, float_buffer=True)
    made.colorspace_settings.name = "sRGB"
    texels = numpy.random.default_rng(1).random((8, 8, 4)).astype(numpy.float32)
    texels[..., 3] = 1
    made.pixels.foreach_set(texels.ravel())
    textured()[2].image = made


@names("colour space Linear ACEScg")
def sixteen_bits_of_another_space():
    path = os.path.join(WORK, "sixteen.png")
    with open(path, "wb") as out:
        out.write(sys.modules["shadowcache.blender_export.pictures"].write_png(numpy.full((2, 2, 3), 0.5), 65535))
    made = textured()[2].image = bpy.data.images.load(path)
    assert made.is_float
    made.colorspace_settings.name = "Linear ACEScg"


@names("its changes are not saved")
def painted():
    made = textured()[2].image
    made.pixels[0] = 0.3
    made.update()


# Attributes and normals.

def of_attribute(name, kind="FLOAT", domain="POINT"):
    material, tree, shader = diffuse()
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_name = name
    tree.links.new(node.outputs["Color"], shader.inputs["Color"])
    plane(material).data.attributes.new("made", kind, domain)


@names("attribute made: float of edge")
def values_of_edges():
    of_attribute("made", domain="EDGE")


@names("attribute generated, which Cycles makes")
def attribute_of_cycles():
    of_attribute("generated")


@names("Smooth shading of coarse facets")
def smooth_cube():
    thing = cube(diffuse()[0])
    for polygon in thing.data.polygons:
        polygon.use_smooth = True


@names("bends steep normals to the view, which makes light brighter or darker (diffuse)")
def normal_map():
    _, tree, node = textured(space="Non-Color")
    turn, shader = tree.nodes.new("ShaderNodeNormalMap"), tree.nodes["Diffuse BSDF"]
    tree.links.new(node.outputs["Color"], turn.inputs["Color"])
    tree.links.new(turn.outputs[0], shader.inputs["Normal"])


# What shows others.

def instanced(collection="shown"):
    """A cube that an Empty shows."""
    plane(diffuse()[0], 6)
    thing = cube(diffuse((0.3, 0.5, 0.7))[0])
    made = bpy.data.collections.new(collection)
    made.objects.link(thing)
    scene().collection.objects.unlink(thing)
    empty = link("empty", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", made
    return empty


@shows
def instance_mirrored():
    instanced().scale = (-1.2, 0.7, 1)


@names("object empty: hidden from the camera")
def instancer_is_hidden():
    instanced().visible_camera = False


@names("object empty: holdout")
def instancer_is_holdout():
    instanced().is_holdout = True


@names("object empty: shadow catcher")
def instancer_catches_shadows():
    instanced().is_shadow_catcher = True


@names("object empty: indirect only")
def instancer_is_indirect():
    empty = instanced()
    made = bpy.data.collections.new("made")
    scene().collection.children.link(made)
    scene().collection.objects.unlink(empty)
    made.objects.link(empty)
    bpy.context.view_layer.layer_collection.children["made"].indirect_only = True


def on_a_mesh(kind, size, **settings):
    """Cubes on the vertices, or the faces, of a bent sheet."""
    plane(diffuse()[0], 6)
    mesh = bpy.data.meshes.new("sheet")
    mesh.from_pydata([(-1.4, -1, 0.2), (1.2, -1, 0.2), (1.2, 1, 0.5), (-1.4, 1, 0.5), (0, 2, 1)], [], [(0, 1, 2, 3), (3, 2, 4)])
    mesh.materials.append(diffuse((0.9, 0.2, 0.1))[0])
    sheet, thing = link("sheet", mesh), cube(diffuse((0.3, 0.5, 0.7))[0])
    thing.scale, thing.location.z, thing.parent = (size,) * 3, 0.05, sheet
    sheet.instance_type = kind
    for name, value in settings.items():
        setattr(sheet, name, value)


@shows
def instances_on_vertices():
    on_a_mesh("VERTS", 0.3, use_instance_vertices_rotation=True, show_instancer_for_render=False)


@shows
def instances_on_faces():
    on_a_mesh("FACES", 0.4, use_instance_faces_scale=True, instance_faces_scale=0.6, show_instancer_for_render=True)


@shows
def instances_of_instances():
    outer = instanced("inner")
    made = bpy.data.collections.new("outer")
    scene().collection.objects.unlink(outer)
    made.objects.link(outer)
    outer.scale, outer.location.x = (0.3, 0.3, 0.3), 0.5
    for x, turn in ((-1.2, 0.3), (0.8, -0.5)):
        shown = link("empty", None)
        shown.instance_type, shown.instance_collection = "COLLECTION", made
        shown.location.x, shown.rotation_euler.z = x, turn


def hairy():
    """A cube, and the modifier that grows hair on it."""
    thing = cube(diffuse((0.3, 0.5, 0.7))[0])
    modifier = thing.modifiers.new("hair", "PARTICLE_SYSTEM")
    thing.particle_systems[0].settings.type = "HAIR"
    return thing, modifier


@shows
def hair_is_off():
    hairy()[1].show_render = False


@names("object cube: hair")
def hair():
    hairy()


@names("object cube: hair")
def hair_of_a_hidden_emitter():
    hairy()[0].show_instancer_for_render = False


# Cameras and scenes.

@shows
def focus_of_an_orthographic_camera():
    """Behind the clip plane, on which Cycles has the lens."""
    camera = scene().camera.data
    camera.type, camera.ortho_scale, camera.clip_start = "ORTHO", 6, 4
    camera.dof.use_dof, camera.dof.focus_distance, camera.dof.aperture_fstop = True, 1.6, 1
    scene().cycles.samples, scene().shadowcache.camera_rays = 8192, 512
    pillar = cube(diffuse((0.9, 0.6, 0.2))[0])
    pillar.location, pillar.scale = (0.5, 0.5, 0), (0.5, 0.5, 0.8)


@names("it is mirrored")
def mirrored_camera():
    scene().camera.scale.x = -1
    plane(diffuse()[0])


@names("its axes are sheared")
def sheared_camera():
    parent = link("parent", None)
    parent.scale, parent.rotation_euler.z = (1, 2, 1), 0.5
    scene().camera.parent = parent
    plane(diffuse()[0])


@names("clip planes, which only CAMERA.json holds")
def clip_planes():
    scene().camera.data.clip_start = 3
    plane(diffuse()[0])


@names("pixel aspect, which only CAMERA.json holds")
def wide_pixels():
    scene().render.pixel_aspect_x = 2
    plane(diffuse()[0])


@names("Fast GI Approximation is on")
def fast_gi():
    scene().cycles.use_fast_gi = True
    plane(diffuse()[0])


# Worlds.

def environment(texels, space, **settings):
    tree = scene().world.node_tree
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = image(texels, space, **settings)
    tree.links.new(node.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    return node


def paint(made, texels):
    made.pixels.foreach_set(numpy.array(texels, numpy.float32).ravel())
    made.update()


def made_in_blender(red, green, blue, space="sRGB"):
    """An Environment Texture node with an image that no file has, of a colour on the left and half of it on the right."""
    made = bpy.data.images.new("made", 8, 4, float_buffer=space == "Linear")
    made.colorspace_settings.name = space
    paint(made, [[(red, green, blue, 1)] * 4 + [(red / 2, green / 2, blue / 2, 1)] * 4] * 4)
    node = scene().world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = made
    return node


@shows
def world_of_images_made_in_blender():
    """Of bytes, of floats, and of one that is packed and painted."""
    bytes_, floats, packed = (made_in_blender(0.9, 0.1, 0), made_in_blender(0, 1.4, 0.3, "Linear"), made_in_blender(0, 0, 0))
    packed.image.pack()
    paint(packed.image, [[(0.2, 0, 0.8, 1)] * 8] * 4)
    tree, colour = scene().world.node_tree, bytes_.outputs["Color"]
    for node in (floats, packed):
        both = tree.nodes.new("ShaderNodeMixRGB")
        both.blend_type, both.inputs[0].default_value = "ADD", 1
        tree.links.new(colour, both.inputs[1])
        tree.links.new(node.outputs["Color"], both.inputs[2])
        colour = both.outputs[0]
    tree.links.new(colour, tree.nodes["Background"].inputs["Color"])
    plane(diffuse()[0])


def light():
    return sys.modules["shadowcache.world_map"].light_of(scene(), bpy.context.view_layer, WORK)[0]


def is_baked():
    return not isinstance(light(), dict)


def encoded_worlds():
    """Cycles bakes a map whose texels it filters as they are encoded; others are read."""
    texels = numpy.random.default_rng(1).random((4, 8, 4))
    texels[..., 3] = 1
    for space, baked in (("sRGB", True), ("Non-Color", False)):
        environment(texels, space)
        assert is_baked() == baked, space
    node = environment(numpy.ones((4, 8, 4)), "sRGB")
    assert not is_baked(), "even texels, encoded"
    node.image.pixels[0] = 0.3
    node.image.update()
    assert is_baked(), "painted, of which Cycles shows the file"
    environment(numpy.ones((4, 8, 4)), "sRGB")
    scene().world.node_tree.nodes["Background"].inputs["Strength"].default_value = -1
    assert is_baked(), "strength below 0"
