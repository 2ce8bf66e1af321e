"""Scenes of one lamp each over a floor with a box, as blender_lamps.py starts them: ZIP PROGRAMS MAP WORK.

Six parts of each picture, and its mean, have the values of Cycles, which are stored in blender_lamps.json. What of a lamp
is not rendered is named. A lamp that is 3 per cent too bright must be told apart, and so must every other lamp.
"""

import math
import os
import sys

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import blender_compare  # noqa: E402
from blender_compare import apart  # noqa: E402
from blender_kit import names, shows  # noqa: E402
from blender_scene import WORK, add_material, install  # noqa: E402

SIZE = (66, 36)
MOST_MEAN, MOST_PART = 0.01, 0.01  # shares of the mean by which the picture's, and a part's, may be off


def lamp(kind, place=(0.6, -0.8, 2.5), turn=(0, 0, 0), scale=(1, 1, 1), **settings):
    made = bpy.data.lights.new("lamp", kind)
    for name, value in settings.items():
        setattr(made, name, value)
    thing = bpy.data.objects.new("lamp", made)
    thing.location, thing.rotation_euler, thing.scale = place, turn, scale
    bpy.context.scene.collection.objects.link(thing)
    return thing


@shows
def point():
    lamp("POINT", energy=100, shadow_soft_size=0)


@shows
def soft_point():
    lamp("POINT", energy=100, shadow_soft_size=0.25, color=(1, 0.5, 0.25), scale=(2, 2, 2))


@shows
def sun():
    lamp("SUN", turn=(0.5, 0.4, 0), energy=3, angle=0)


@shows
def wide_sun():
    lamp("SUN", turn=(0.5, 0.4, 0), energy=3, angle=0.5)


@shows
def spot():
    lamp("SPOT", turn=(0.2, 0.1, 0), energy=300, shadow_soft_size=0.05, spot_size=1, spot_blend=0.15)


@shows
def soft_spot():
    lamp("SPOT", turn=(-0.1, 0.3, 0), energy=300, shadow_soft_size=0.3, spot_size=1.6, spot_blend=1)


@shows
def hard_spot():
    bpy.context.scene.cycles.samples, bpy.context.scene.shadowcache.camera_rays = 8192, 512
    lamp("SPOT", turn=(0.2, 0.1, 0), energy=300, shadow_soft_size=0.05, spot_size=math.radians(60), spot_blend=0)


@shows
def square():
    lamp("AREA", turn=(0.3, 0.1, 0), energy=100, shape="SQUARE", size=0.8)


@shows
def rectangle():
    lamp("AREA", turn=(0.3, 0.1, 0.5), energy=100, shape="RECTANGLE", size=0.3, size_y=2, scale=(1, 0.5, 1))


@shows
def disc():
    lamp("AREA", turn=(-0.3, 0.4, 0), energy=100, shape="DISK", size=1)


@shows
def ellipse():
    lamp("AREA", turn=(0, 0.6, 0), energy=100, shape="ELLIPSE", size=0.2, size_y=1.2, scale=(2, 1, 1))


@shows
def spread():
    lamp("AREA", turn=(0.3, 0.1, 0), energy=100, shape="RECTANGLE", size=0.8, size_y=0.3, spread=1.2)


@shows
def narrow_spread():
    """A bright spot, around which all light bounces."""
    bpy.context.scene.cycles.samples, bpy.context.scene.shadowcache.camera_rays = 20000, 512
    lamp("AREA", turn=(-0.1, 0.3, 0), energy=100, shape="DISK", size=1.5, spread=0.2)


@shows
def wide_spread():
    """Near the floor, and seen from the side."""
    lamp("AREA", place=(0.9, -0.6, 0.3), turn=(0.9, 0.2, 0), energy=20, size=0.8, spread=2.6).visible_camera = True


@shows
def moving():
    """Seen where it is in frame 4, as large as it is there."""
    thing = lamp("AREA", turn=(0, 0, 0), energy=100, shape="RECTANGLE", size=0.3, size_y=0.6, spread=2)
    thing.visible_camera = True
    scene = bpy.context.scene
    for frame, place, turn, scale in ((1, (3, 0, 3), (0, 0, 0), (1, 1, 1)), (7, (-1, -1, 0.6), (0.4, 0.8, 0.3), (2, 3, 1))):
        thing.location, thing.rotation_euler, thing.scale = place, turn, scale
        for path in ("location", "rotation_euler", "scale"):
            thing.keyframe_insert(path, frame=frame)
    scene.frame_start, scene.frame_end = 1, 7
    scene.frame_set(4)


@shows
def nodes():
    thing = lamp("POINT", place=(-1, -1, 1.5), energy=50, shadow_soft_size=0.1)
    thing.data.use_nodes = True
    inputs = thing.data.node_tree.nodes["Emission"].inputs
    inputs["Color"].default_value, inputs["Strength"].default_value = (0.2, 1, 0.5, 1), 2


@shows
def muted_output():
    """Beside a lamp that shines."""
    lamp("POINT", place=(1, 1, 2), energy=60, shadow_soft_size=0.1, color=(1, 0.6, 0.2))
    thing = lamp("POINT", energy=100)
    thing.data.use_nodes = True
    thing.data.node_tree.nodes["Light Output"].mute = True


@shows
def seen():
    """Some before the floor and the box, one half hidden, one from behind, one through another."""
    lamp("POINT", place=(-1.8, 0.3, 1), energy=20, shadow_soft_size=0.35, color=(1, 0.4, 0.2)).visible_camera = True
    lamp("AREA", place=(1.3, -0.5, 1), turn=(1.1, 0, 0), energy=6, shape="RECTANGLE", size=1, size_y=0.5).visible_camera = True
    lamp("AREA", place=(0, -1.5, 0.3), turn=(-2, 0, 0), energy=5, shape="DISK", size=0.8).visible_camera = True
    lamp("SPOT", place=(1.5, -0.8, 0.8), turn=(0.9, 0.2, 0), energy=15, shadow_soft_size=0.3, spot_size=1.4, spot_blend=0.5,
         color=(0.2, 0.4, 1)).visible_camera = True
    lamp("POINT", place=(-0.3, 0.8, 0.7), energy=10, shadow_soft_size=0.3).visible_camera = True
    lamp("POINT", place=(0.3, -2, 1), energy=2, shadow_soft_size=0.2)


@shows
def seen_sun():
    lamp("SUN", turn=(-1.25, 0.05, 0), energy=1, angle=0.2).visible_camera = True
    bpy.context.scene.camera.rotation_euler.x = math.radians(100)


@shows
def several():
    lamp("POINT", place=(-1.5, 0.5, 1), energy=30, shadow_soft_size=0.1, color=(1, 0.2, 0.2))
    lamp("SUN", turn=(0.7, 0, 0), energy=0.5, angle=0.05)
    lamp("AREA", place=(1.5, 0.5, 1), turn=(0, 1.2, 0), energy=20, shape="DISK", size=0.5, color=(0.2, 0.2, 1))


@names("light lamp: seen by the camera, as in Cycles where a lamp has Multiple Importance")
def seen_by_chance():
    thing = lamp("AREA")
    thing.visible_camera, thing.data.cycles.use_multiple_importance_sampling = True, False


@names("light lamp: Cast Shadow is off")
def shadowless():
    lamp("POINT").data.cycles.cast_shadow = False


@names("light lamp: hidden from glossy rays")
def not_glossy():
    lamp("POINT").visible_glossy = False


@names("light hidden from the camera: seen through glass in Cycles, not here (lamp)")
def behind_glass():
    lamp("POINT", shadow_soft_size=0.2).visible_camera = False
    lamp("POINT", shadow_soft_size=0).visible_camera = False  # a point is not seen
    tree = bpy.data.objects["Cube"].active_material.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeBsdfGlass").outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])


def coloured_by(node, **settings):
    """A lamp whose colour is a node's."""
    thing = lamp("POINT", **settings)
    thing.data.use_nodes = True
    tree = thing.data.node_tree
    made = tree.nodes.new(node)
    tree.links.new(made.outputs[0], tree.nodes["Emission"].inputs["Color"])
    return made


@shows
def blackbody():
    coloured_by("ShaderNodeBlackbody", energy=100, shadow_soft_size=0.1).inputs["Temperature"].default_value = 2700


@names("light lamp: Color: node Wavelength")
def driven_by_nodes():
    coloured_by("ShaderNodeWavelength")


@names("light lamp: wide; Cycles has a sun brighter")
def half_a_sky_of_sun():
    lamp("SUN", angle=2.4)


@names("light lamp: wide; Cycles has a sun brighter")
def wide_sun_that_is_seen():
    lamp("SUN", angle=0.5).visible_camera = True


@names("light lamp: a narrow spread")
def beam():
    lamp("AREA", spread=0.02)


@names("light lamp: a scale of 0")
def no_scale():
    lamp("POINT", scale=(0, 0, 0))


@names("light lamp: light below 0")
def negative():
    lamp("POINT", energy=-5)


def start():
    """A camera over a floor with a box, at night."""
    for kind in (bpy.data.objects, bpy.data.meshes, bpy.data.lights, bpy.data.materials, bpy.data.worlds):
        for item in list(kind):
            kind.remove(item)
    bpy.ops.mesh.primitive_plane_add(size=8)
    add_material(bpy.context.object, (0.7, 0.6, 0.5))
    bpy.ops.mesh.primitive_cube_add(size=1, location=(-0.3, 0.2, 0.5))
    add_material(bpy.context.object, (0.4, 0.5, 0.8))
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0, -5, 4), (math.radians(52), 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = *SIZE, 100
    render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    render.image_settings.color_depth, render.image_settings.exr_codec = "32", "NONE"
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.use_adaptive_sampling, cycles.use_denoising = 512, 1, False, False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = 0
    settings = scene.shadowcache
    settings.cache_folder = os.path.join(WORK, "cache")
    settings.camera_rays, settings.samples, settings.bounces, settings.bake_spacing = 64, 4, 1, 0.5


VALUES = blender_compare.Values("blender_lamps.json", start, "RGB")


def compare():
    values = VALUES.compare(MOST_MEAN, MOST_PART)
    assert apart(values["point"] * 1.03, values["point"])[0] > MOST_MEAN, "control: 3 % more light is not told apart"
    for name, other in zip(values, list(values)[1:]):
        assert apart(values[name], values[other])[1] > MOST_PART, "control: %s looks like %s" % (name, other)


def left_out_of(depsgraph, _):
    return sys.modules["shadowcache.blender_export"].export(depsgraph, os.path.join(WORK, "named.glb"))


def names_all():
    blender_compare.names_all(start, left_out_of)


def named_after_an_export():
    """What is changed in a lamp when its set is exported, and needs no other."""
    start()
    thing = lamp("POINT", energy=100)
    assert not blender_compare.render("SHADOWCACHE", "RGB")[1]
    thing.visible_diffuse = False
    _, left_out = blender_compare.render("SHADOWCACHE", "RGB")
    assert left_out == ["light lamp: hidden from diffuse rays"], left_out


def cones():
    """Of spots of all whole degrees: the inner angle is at most the outer one, and right."""
    export = sys.modules["shadowcache.blender_export.lamps"]
    start()
    thing = lamp("SPOT")
    for degrees in range(1, 181):
        for blend in (0, 0.15, 1):
            thing.data.spot_size, thing.data.spot_blend = math.radians(degrees), blend
            cone = export.of_spot(thing, 1)["spot"]
            height = math.cos(math.radians(degrees / 2))
            inner, outer = cone["innerConeAngle"], cone["outerConeAngle"]
            assert 0 <= inner <= outer <= math.pi / 2, (degrees, blend, cone)
            assert abs(outer - math.radians(degrees / 2)) < 1e-6, (degrees, cone)
            assert abs(math.cos(inner) - (height + (1 - height) * blend)) < 1e-6, (degrees, blend, cone)


install()
blender_compare.run(VALUES.store, (compare, names_all, named_after_an_export, cones))
