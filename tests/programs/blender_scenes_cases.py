"""Small scenes of one feature each, as blender_scenes.py starts them: ZIP PROGRAMS MAP WORK.

What is rendered has the values of Cycles, which are stored in blender_scenes.json, in six parts of the picture; what is
not rendered is named. The plain scene must be told apart from those that differ.
"""

import math
import os
import sys

import bpy
import numpy

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import blender_compare  # noqa: E402
import blender_scenes_files  # noqa: E402
import blender_scenes_found  # noqa: E402
from blender_compare import apart, render  # noqa: E402
from blender_kit import (checks, cube, diffuse, image, link, names, placed, plane,  # noqa: E402
                         principled, shows, start, textured, world_node)
from blender_scene import WORK, install  # noqa: E402

MOST = 0.015  # share of the mean by which a part may be off
MOST_BLACK = 0.005  # share of the greatest number by which a colour of a black body may be off


# Nodes that are muted, links that do not count.

@shows
def plain():
    plane(diffuse((0.5, 0.3, 0.1))[0])


def mixed(**settings):
    material, tree, shader = diffuse()
    mix, colour = tree.nodes.new("ShaderNodeMixRGB"), tree.nodes.new("ShaderNodeRGB")
    colour.outputs[0].default_value = (0.6, 0.4, 0.2, 1)
    mix.blend_type, mix.inputs[0].default_value, mix.inputs[1].default_value = "MULTIPLY", 1, (0.5, 0.5, 0.5, 1)
    tree.links.new(colour.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], shader.inputs["Color"])
    plane(material)
    return tree, mix, shader


@shows
def mix_multiplies():
    mixed()


@shows
def muted_mix():
    mixed()[1].mute = True


@shows
def muted_mix_unlinked():
    tree, mix, _ = mixed()
    mix.mute = True
    tree.links.remove(mix.inputs[2].links[0])


@shows
def muted_image():
    textured(mute=True)


@shows
def muted_shader():
    material, _, shader = diffuse()
    shader.mute = True
    plane(material)


@shows
def muted_link():
    tree, _, shader = mixed()
    shader.inputs["Color"].links[0].is_muted = True


@shows
def reroutes():
    tree, mix, shader = mixed()
    first, second = (tree.nodes.new("NodeReroute") for _ in range(2))
    tree.links.new(mix.outputs[0], first.inputs[0])
    tree.links.new(first.outputs[0], second.inputs[0])
    tree.links.new(second.outputs[0], shader.inputs["Color"])


@shows
def muted_output():
    material, tree, _ = diffuse()
    tree.nodes["Material Output"].mute = True
    plane(material)


# What stands for no material.

@shows
def no_material():
    plane(None)


@shows
def empty_slot():
    plane(diffuse((0.1, 0.1, 0.1))[0]).data.materials[0] = None


@shows
def no_surface():
    material, tree, _ = diffuse()
    tree.nodes.clear()
    plane(material)


@shows
def seen_from_behind():
    material, _, _ = diffuse((0.3, 0.6, 0.9))
    material.use_backface_culling = True
    plane(material).rotation_euler.x = math.pi


# Images.

@shows
def straight_alpha_alone():
    textured(checks(alpha=0.25))


@shows
def straight_alpha():
    material, tree, shader = principled(Base_Color=(0, 0, 0, 1), Specular=0, Emission_Strength=1)
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.interpolation = image(checks(alpha=0.25)), "Closest"
    tree.links.new(node.outputs["Color"], shader.inputs["Emission"])
    tree.links.new(node.outputs["Alpha"], shader.inputs["Alpha"])
    plane(material)


@shows
def linear_bytes():
    textured(space="Linear")


@shows
def filtered_as_stored():
    textured()


@shows
def closest():
    textured(interpolation="Closest")


@shows
def cubic():
    textured(interpolation="Cubic")


@shows
def clipped():
    _, tree, node = textured(extension="CLIP")
    placed(node, tree, Scale=(1.7, 1.7, 1), Location=(-0.4, -0.3, 0))


@shows
def extended():
    _, tree, node = textured(extension="EXTEND")
    placed(node, tree, Scale=(1.7, 1.7, 1), Location=(-0.4, -0.3, 0))


@shows
def mapped_as_texture():
    _, tree, node = textured()
    placed(node, tree, kind="TEXTURE", Scale=(0.5, 0.8, 1), Location=(-0.4, -0.3, 0), Rotation=(0, 0, 0.4))


@shows
def mapped_by_itself():
    _, _, node = textured()
    node.texture_mapping.scale, node.texture_mapping.rotation[2] = (2, 1, 1), 0.3


@shows
def generated():
    _, tree, node = textured()
    placed(node, tree, "Generated", Scale=(1.5, 1.5, 1))


@shows
def of_object():
    _, tree, node = textured()
    placed(node, tree, "Object", Scale=(0.3, 0.4, 1))


@shows
def no_image():
    material, tree, shader = diffuse()
    tree.links.new(tree.nodes.new("ShaderNodeTexImage").outputs[0], shader.inputs["Color"])
    plane(material)


@shows
def colour_to_number():
    material, tree, shader = principled(Base_Color=(0, 0, 0, 1), Specular=0, Emission=(0.5, 0.4, 0.3, 1), Emission_Strength=1)
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image([[(0, 1, 0, 1)] * 2] * 2, "Non-Color")
    tree.links.new(node.outputs["Color"], shader.inputs["Alpha"])
    plane(material)


# Attributes.

def attributed(kind, domain, values):
    thing, tree, node = textured()
    where = tree.nodes.new("ShaderNodeAttribute")
    where.attribute_name = "places"
    tree.links.new(where.outputs["Vector"], node.inputs["Vector"])
    made = thing.data.attributes.new("places", kind, domain)
    made.data.foreach_set("vector", values)


@shows
def places_of_corners():
    attributed("FLOAT_VECTOR", "CORNER", [0, 0, 5, 1, 0, 5, 1, 2, 5, 0, 2, 5])


@shows
def places_of_points():
    attributed("FLOAT2", "POINT", [0, 0, 2, 0, 2, 1, 0, 1])


def coloured(name):
    material, tree, shader = diffuse()
    node = tree.nodes.new("ShaderNodeAttribute")
    node.attribute_name = name
    tree.links.new(node.outputs["Color"], shader.inputs["Color"])
    thing = cube(material)
    made = thing.data.attributes.new("colours", "FLOAT_COLOR", "FACE")
    made.data.foreach_set("color", [0.1 * (i % 9) for i in range(24)])


@shows
def colours_of_faces():
    coloured("colours")


@shows
def missing_colours():
    coloured("none")


# Objects, scenes and worlds.

@shows
def a_vertex_is_no_number():
    plane(diffuse()[0], 6)
    cube(diffuse((0.3, 0.5, 0.7))[0]).data.vertices[7].co = (math.nan,) * 3


@shows
def all_moves():
    thing = cube(diffuse((0.3, 0.5, 0.7))[0])
    for frame in (1, 3):
        thing.rotation_euler.z = 0.5 * frame
        thing.keyframe_insert("rotation_euler", frame=frame)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 3
    scene.frame_set(2)


@shows
def background_set():
    plane(diffuse()[0], 6)
    other = bpy.data.scenes.get("other") or bpy.data.scenes.new("other")
    thing = cube(diffuse((0.3, 0.5, 0.7))[0])
    bpy.context.scene.collection.objects.unlink(thing)
    other.collection.objects.link(thing)
    bpy.context.scene.background_set = other


@shows
def sky_is_off():
    bpy.context.view_layer.use_sky = False
    plane(diffuse()[0])


@shows
def world_is_muted():
    bpy.context.scene.world.node_tree.nodes["Background"].mute = True
    plane(diffuse()[0])


@shows
def output_of_world_is_muted():
    """A lit plane under no sky."""
    bpy.context.scene.world.node_tree.nodes["World Output"].mute = True
    glow, _, _ = principled(Base_Color=(0, 0, 0, 1), Specular=0, Emission=(0.2, 0.4, 0.1, 1), Emission_Strength=1)
    plane(glow)


@shows
def colour_to_world_strength():
    tree, node, background = world_node("ShaderNodeRGB")
    node.outputs[0].default_value = (0.2, 0.5, 0.9, 1)
    tree.links.new(node.outputs[0], background.inputs["Strength"])
    plane(diffuse()[0])


def black_body(tree, socket, kelvins):
    node = tree.nodes.new("ShaderNodeBlackbody")
    node.inputs["Temperature"].default_value = kelvins
    tree.links.new(node.outputs["Color"], socket)
    return node


@shows
def blackbody_emitter():
    plane(diffuse()[0])
    material, tree, _ = diffuse()
    shader = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(shader.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    black_body(tree, shader.inputs["Color"], 1900)
    plane(material, 1).location = 0.8, 0.3, 0.4


@shows
def blackbody_world():
    tree, _, background = world_node("ShaderNodeRGB")
    black_body(tree, background.inputs["Color"], 9000)
    plane(diffuse()[0])


@names("Base Color: node Blackbody")
def blackbody_of_an_image():
    _, tree, texture = textured()
    shader = next(node for node in tree.nodes if node.type == "BSDF_DIFFUSE")
    tree.links.new(texture.outputs["Color"], black_body(tree, shader.inputs["Color"], 5000).inputs["Temperature"])


# Emission beside another shader.

RED = "ShaderNodeEmission", {"Color": (1, 0.3, 0.1, 1), "Strength": 0.8}
GREEN = "ShaderNodeBsdfDiffuse", {"Color": (0.3, 0.8, 0.4, 1)}


def glowing(kind, *sides, factor=0.5):
    """A plane over the floor, whose shader adds or mixes two."""
    material, tree, _ = diffuse()
    join(tree, kind, [shader_of(tree, *side) for side in sides], tree.nodes["Material Output"].inputs["Surface"], factor)
    plane(diffuse()[0])
    plane(material, 2).location = 0.3, 0.2, 0.5
    return tree


def shader_of(tree, kind, values):
    node = tree.nodes.new(kind)
    for name, value in values.items():
        node.inputs[name].default_value = value
    return node


def join(tree, kind, sides, to, factor=0.5):
    node = tree.nodes.new(kind)
    if kind == "ShaderNodeMixShader":
        node.inputs[0].default_value = factor
    for side, socket in zip(sides, [s for s in node.inputs if s.type == "SHADER"]):
        tree.links.new(side.outputs[0], socket)
    tree.links.new(node.outputs[0], to)
    return node


@shows
def emission_added():
    glowing("ShaderNodeAddShader", GREEN, RED)


@shows
def emission_mixed():
    glowing("ShaderNodeMixShader", RED, GREEN, factor=0.3)


@shows
def emission_mixed_as_second():
    glowing("ShaderNodeMixShader", GREEN, RED, factor=0.3)


@shows
def emissions_added():
    glowing("ShaderNodeAddShader", RED, ("ShaderNodeEmission", {"Color": (0.1, 0.2, 1, 1), "Strength": 2}))


@shows
def emission_added_to_principled():
    glowing("ShaderNodeAddShader", RED, ("ShaderNodeBsdfPrincipled", {
        "Base Color": (0.1, 0.3, 0.2, 1), "Specular": 0, "Roughness": 0.5, "Emission": (0, 0, 0.4, 1), "Emission Strength": 0.5}))


@shows
def emission_mixed_with_principled():
    glowing("ShaderNodeMixShader", RED, ("ShaderNodeBsdfPrincipled", {
        "Base Color": (0.1, 0.3, 0.2, 1), "Specular": 0.3, "Roughness": 0.4, "Emission": (0, 0, 0.4, 1),
        "Emission Strength": 0.5}), factor=0.6)


@shows
def emission_mixed_with_an_image():
    _, tree, _ = textured()
    to = tree.nodes["Material Output"].inputs["Surface"]
    join(tree, "ShaderNodeMixShader", [to.links[0].from_node, shader_of(tree, *RED)], to, 0.4)


@shows
def emission_added_below_holes():
    tree = glowing("ShaderNodeAddShader", GREEN, RED)
    to = tree.nodes["Material Output"].inputs["Surface"]
    join(tree, "ShaderNodeMixShader", [tree.nodes.new("ShaderNodeBsdfTransparent"), to.links[0].from_node], to, 0.7)


@shows
def emission_added_above_holes():
    tree = glowing("ShaderNodeMixShader", ("ShaderNodeBsdfTransparent", {}), GREEN, factor=0.7)
    to = tree.nodes["Material Output"].inputs["Surface"]
    join(tree, "ShaderNodeAddShader", [shader_of(tree, *RED), to.links[0].from_node], to)


@names("Mix Shader; the viewport's colour is in its place")
def emission_mixed_with_metal():
    glowing("ShaderNodeMixShader", RED, ("ShaderNodeBsdfPrincipled", {"Metallic": 1}))


@names("Add Shader; the viewport's colour is in its place")
def emission_added_to_holes_of_principled():
    glowing("ShaderNodeAddShader", RED, ("ShaderNodeBsdfPrincipled", {"Alpha": 0.5}))


@names("Add Shader; the viewport's colour is in its place")
def emission_added_to_a_pane():
    glowing("ShaderNodeAddShader", RED, ("ShaderNodeBsdfTransparent", {}))


@names("Mix Shader; the viewport's colour is in its place")
def emission_mixed_with_a_pane():
    glowing("ShaderNodeMixShader", ("ShaderNodeBsdfGlass", {}), RED)


@names("Add Shader; the viewport's colour is in its place")
def surfaces_added():
    glowing("ShaderNodeAddShader", GREEN, GREEN)


@names("Emission that varies over the surface otherwise than by one image")
def emission_added_to_one_with_an_image():
    tree = glowing("ShaderNodeAddShader", RED, ("ShaderNodeEmission", {}))
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image(checks())
    tree.links.new(texture.outputs["Color"], next(
        n for n in tree.nodes if n.type == "EMISSION" and n.inputs["Strength"].default_value == 1).inputs["Color"])


# What is named.

# Panes.

def mixed_shaders(factor, first, second):
    """A material that mixes two shaders, each a type and its inputs, by a number or by a type of node."""
    material, tree, _ = diffuse()
    mix = tree.nodes.new("ShaderNodeMixShader")
    if isinstance(factor, str):
        tree.links.new(tree.nodes.new(factor).outputs[0], mix.inputs[0])
    else:
        mix.inputs[0].default_value = factor
    for k, (kind, inputs) in enumerate((first, second)):
        node = tree.nodes.new(kind)
        for name, value in inputs.items():
            node.inputs[name].default_value = value
        tree.links.new(node.outputs[0], mix.inputs[k + 1])
    tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return material


def transparent(*colour):
    return "ShaderNodeBsdfTransparent", {"Color": (*colour, 1)}


MIRROR = "ShaderNodeBsdfGlossy", {"Color": (1, 1, 1, 1), "Roughness": 0}


def above(material):
    """A pane over the floor."""
    plane(diffuse((0.8, 0.8, 0.8))[0])
    plane(material, 2, "pane").location = 0, 0, 1


def upright(material):
    """A pane behind the floor, whose front is towards it and the camera."""
    plane(diffuse((0.8, 0.8, 0.8))[0]).location = 0, -1, 0
    pane = plane(material, 4, "pane")
    pane.location, pane.rotation_euler = (0, 1, 2), (math.pi / 2, 0, 0)


@shows
def transparent_is_tinted():
    material, tree, shader = diffuse()
    node = tree.nodes.new("ShaderNodeBsdfTransparent")
    node.inputs["Color"].default_value = 0.9, 0.5, 0.2, 1
    tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    above(material)


@shows
def mix_with_transparent_by_a_number():
    above(mixed_shaders(0.3, transparent(1, 1, 1), ("ShaderNodeBsdfDiffuse", {"Color": (0.1, 0.6, 0.2, 1)})))


@names("Mix of Transparent and Glossy by a number")
def mix_of_transparent_and_mirror_by_a_number():
    above(mixed_shaders(0.2, transparent(0.3, 0.6, 0.9), MIRROR))


@shows
def mix_of_transparent_and_mirror_by_fresnel():
    upright(mixed_shaders("ShaderNodeFresnel", transparent(0.6, 0.8, 0.3), MIRROR))


def panes(count):
    """One above the other, over a floor."""
    pane = mixed_shaders(0.2, transparent(1, 1, 1), ("ShaderNodeBsdfDiffuse", {"Color": (0.9, 0.2, 0.1, 1)}))
    above(pane)
    for i in range(1, count):
        plane(pane, 2, "pane").location.z = 1 + 0.1 * i


@shows
def as_many_panes_as_light_passes():
    """Four on the way to the floor, and four on the way back: noisy, as each stops light by chance."""
    bpy.context.scene.shadowcache.camera_rays = 96
    panes(4)


@names("Cycles ends light behind 8 transparent surfaces, here it goes on (diffuse)")
def more_panes_than_light_passes():
    panes(5)


@names("glass: light passes straight")
def glass():
    above(mixed_shaders(1, transparent(1, 1, 1), ("ShaderNodeBsdfGlass", {"Roughness": 0})))


@names("glass: light passes straight")
def principled_transmission():
    above(principled(Transmission=1, Roughness=0)[0])


@names("Is Shadow Ray: here light to surfaces behind the glass")
def glass_without_shadow():
    material = mixed_shaders(0, ("ShaderNodeBsdfGlass", {"Roughness": 0}), transparent(1, 1, 1))
    tree = material.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs["Is Shadow Ray"], tree.nodes["Mix Shader"].inputs[0])
    above(material)


@names("Mix Shader; the viewport's colour is in its place")
def mix_of_two_surfaces():
    above(mixed_shaders(0.5, ("ShaderNodeBsdfDiffuse", {}), ("ShaderNodeBsdfGlossy", {})))


@names("Base Color below 0 or above 1")
def bright():
    plane(diffuse((2, 0.5, 0.5))[0])


@names("Base Color below 0 or above 1")
def bright_without_nodes():
    material, _, _ = diffuse()
    material.use_nodes, material.diffuse_color = False, (2, 0.5, 0.5, 1)
    plane(material)


def fed(socket, number):
    """A plane with a number that a node makes, which no editor bounds."""
    material, tree, shader = principled()
    node = tree.nodes.new("ShaderNodeValue")
    node.outputs[0].default_value = number
    tree.links.new(node.outputs[0], shader.inputs[socket])
    plane(material)


@names("Metallic below 0 or above 1")
def too_metallic():
    fed("Metallic", 2)


@names("Roughness below 0 or above 1")
def too_rough():
    fed("Roughness", 2)


@names("Specular below 0 or above 1")
def too_specular():
    fed("Specular", 3)


@names("colour space XYZ")
def space():
    textured(space="XYZ")


@names("premultiplied alpha")
def premultiplied():
    textured(checks(alpha=0.25))[2].image.alpha_mode = "PREMUL"


@names("Projection is BOX")
def box():
    textured(projection="BOX")


@names("placed by Mapping")
def mapped_as_normal():
    _, tree, node = textured()
    placed(node, tree, kind="NORMAL")


@names("placed by Mapping")
def mapped_from_a_muted_node():
    """Which hands nothing on, so that the Mapping's own vector counts."""
    _, tree, node = textured()
    placed(node, tree)
    tree.nodes["Texture Coordinate"].mute = True


@names("Brightness is 2")
def colour_mapping():
    textured()[2].color_mapping.brightness = 2


@names("material diffuse: Roughness")
def rough_diffuse():
    material, _, shader = diffuse()
    shader.inputs["Roughness"].default_value = 0.5
    plane(material)


@names("Principled BSDF: its lobes")
def lobes():
    plane(principled()[0])


@names("Distribution is MULTI_GGX")
def multiple_scattering():
    material, _, shader = principled()
    shader.distribution = "MULTI_GGX"
    plane(material)


def hidden(flag):
    setattr(plane(diffuse()[0]), flag, False)


@names("hidden from diffuse rays")
def no_diffuse_rays():
    hidden("visible_diffuse")


@names("hidden from glossy rays")
def no_glossy_rays():
    hidden("visible_glossy")


@names("indirect only")
def indirect_only():
    thing = plane(diffuse()[0])
    made = bpy.data.collections.new("made")
    bpy.context.scene.collection.children.link(made)
    bpy.context.scene.collection.objects.unlink(thing)
    made.objects.link(thing)
    bpy.context.view_layer.layer_collection.children["made"].indirect_only = True


@names("motion blur")
def motion_blur():
    bpy.context.scene.render.use_motion_blur = True
    plane(diffuse()[0])


@names("Exposure is 2")
def exposure():
    bpy.context.scene.cycles.film_exposure = 2
    plane(diffuse()[0])


@names("Ratio is 2")
def aperture_ratio():
    dof = bpy.context.scene.camera.data.dof
    dof.use_dof, dof.aperture_ratio = True, 2
    plane(diffuse()[0])


@names("world world: Volume")
def world_volume():
    tree, node, _ = world_node("ShaderNodeVolumeScatter")
    tree.links.new(node.outputs[0], tree.nodes["World Output"].inputs["Volume"])
    plane(diffuse()[0])


@names("world world: attribute light of the view layer")
def world_of_view_layer():
    tree, node, background = world_node("ShaderNodeAttribute")
    node.attribute_type, node.attribute_name = "VIEW_LAYER", "light"
    tree.links.new(node.outputs["Fac"], background.inputs["Strength"])
    plane(diffuse()[0])


@names("Max Bounces is 0")
def world_bounces():
    bpy.context.scene.world.cycles.max_bounces = 0
    plane(diffuse()[0])


VALUES = blender_compare.Values("blender_scenes.json", start, "RGBA")


def is_of_cycles(scene, entry):
    """Whether an entry is of what holds for a material anywhere, or of a scene that is to be named and shown."""
    return entry.startswith(("Principled BSDF: ", "Fresnel: ")) or scene == "a_vertex_is_no_number"


def compare():
    values = VALUES.compare(MOST, MOST, is_of_cycles)
    assert apart(values["plain"] * 1.03, values["plain"])[1] > MOST, "control: 3 % more light is not told apart"
    told = [name for name in values if apart(values["plain"], values[name])[1] > MOST]
    assert len(told) == len(values) - 1, "control: %s look like the plain scene" % (set(values) - set(told))


def left_out_of(depsgraph, _):
    """What a render of a depsgraph names, without the render."""
    part = {name: sys.modules["shadowcache." + name] for name in ("scene_check", "world_map")}
    _, of_world = part["world_map"].light_of(depsgraph.scene, depsgraph.view_layer, WORK)
    of_scene = part["scene_check"].left_out(depsgraph, depsgraph.scene.camera)
    return blender_export().export(depsgraph, os.path.join(WORK, "named.glb")) + of_world + of_scene


def blender_export():
    return sys.modules["shadowcache.blender_export"]


def names_all():
    blender_compare.names_all(start, left_out_of)


def encoded_worlds():
    start()
    blender_scenes_found.encoded_worlds()


def map_files():
    start()
    blender_scenes_files.map_files()


def light_below_nothing():
    """Negative texels of a map are named, also where the map is not sent again."""
    start()
    plane(diffuse()[0])
    made = bpy.data.images.new("below", 8, 4, float_buffer=True)
    made.colorspace_settings.name = "Linear"
    made.pixels.foreach_set([-0.5, 0.5, 0.5, 1] * 32)
    tree, node, background = world_node("ShaderNodeTexEnvironment")
    node.image = made
    tree.links.new(node.outputs["Color"], background.inputs["Color"])
    for _ in range(2):
        _, left_out = render("SHADOWCACHE", "RGBA")
        assert any("32 negative, set to 0, 33 % of the light" in entry for entry in left_out), left_out


def black_bodies():
    """Colours of all temperatures are those that Cycles shows; 2 per cent more of it is told apart."""
    start()
    scene = bpy.context.scene
    scene.render.film_transparent, scene.cycles.samples = False, 1
    tree, _, background = world_node("ShaderNodeRGB")
    node = black_body(tree, background.inputs["Color"], 1000)
    colour = sys.modules["shadowcache.blender_export.blackbody"].colour
    for kelvins in (0, 800, 900, 1000, 1150, 1300, 1600, 1900, 2300, 2700, 3300, 4000, 5000, 6300, 6500, 8000, 10000, 11900,
                    12000, 20000):
        node.inputs["Temperature"].default_value = kelvins
        shown = render("CYCLES", "RGB")[0][0]
        gap, more = (abs(numpy.array(colour(of)) / shown.max() - shown / shown.max()).max() for of in (kelvins, 1.02 * kelvins))
        print("case black body of %d K: off by %.5f, of 2 %% more by %.5f" % (kelvins, gap, more))
        assert gap < MOST_BLACK and (more > MOST_BLACK or not 800 <= kelvins <= 10000), (colour(kelvins), shown)


def strengths():
    """Normals of a map that counts half are mixed with the surface's, as Cycles does."""
    mixed = sys.modules["shadowcache.blender_export.materials"].mixed_normals(numpy.array([[[0.8, 0.5, 0.9]]]), 0.5)
    wanted = numpy.array([0.3, 0, 0.9]) / math.hypot(0.3, 0.9) / 2 + 0.5
    assert abs(mixed[0, 0] - wanted).max() < 1e-6, mixed


if __name__ == "__main__":
    install()
    blender_compare.run(VALUES.store, (compare, names_all, encoded_worlds, map_files, light_below_nothing, strengths, black_bodies))
