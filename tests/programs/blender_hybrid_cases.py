"""Hybrids in a real Blender, as blender_hybrid.py starts it: ZIP PROGRAMS MAP WORK.

The composed picture is compared with that of Cycles alone; one without the light of lamps, without masks, under a turned
map, or with other lamps must be told apart.
"""

import os
import sys
import time

import bpy
import numpy

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import blender_exr  # noqa: E402
from blender_scene import WORK, apart, error_of, install, make_scene, make_world  # noqa: E402

MOST_MEAN, MOST_TILES = 0.01, 0.02
NAME = "Shadowcache Hybrid"
TURN = (20, -35, 50)


def principled(name, **inputs):
    """Another shader for a material."""
    tree = bpy.data.materials[name].node_tree
    tree.nodes.clear()
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    for key, value in inputs.items():
        shader.inputs[key.replace("_", " ")].default_value = value
    tree.links.new(shader.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])


def make_rich():
    """A set that this engine has not all of: a metal floor, lamps, of which the camera sees one, an emitter, rough glass."""
    make_scene()
    make_world(turn=TURN)
    principled("Plane", Base_Color=(0.5, 0.4, 0.3, 1), Roughness=0.35, Metallic=1)
    principled("Cube.002", Base_Color=(0.5, 0.5, 0.6, 1), Roughness=0.4, Transmission=1)
    bpy.data.materials["Cube"].node_tree.nodes["Emission"].inputs["Strength"].default_value = 2
    add_lamp("lamp", "AREA", (0, -3, 4), energy=80, size=4)
    add_lamp("bulb", "POINT", (-0.6, -1.5, 1.9), energy=5, shadow_soft_size=0.25).visible_camera = True
    scene = bpy.context.scene
    scene.cycles.max_bounces, scene.cycles.samples = 4, 1536
    scene.cycles.sample_clamp_indirect = 2  # less noise, and the same light on both sides
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.shadowcache.bounces = 4


def add_lamp(name, kind, place, **settings):
    lamp = bpy.data.lights.new(name, kind)
    for key, value in settings.items():
        setattr(lamp, key, value)
    thing = bpy.data.objects.new(name, lamp)
    thing.location = place
    bpy.context.scene.collection.objects.link(thing)
    return thing


def picture(prefix, path=None):
    """RGBA of a layer, or of the compositor."""
    found = blender_exr.read(path or bpy.context.scene.render.filepath)
    return numpy.stack([found["%s.Combined.%s" % (prefix, c)] for c in "RGBA"]).astype(float)


def by_cycles():
    scene = bpy.context.scene
    scene.render.engine, scene.render.use_compositing = "CYCLES", False
    bpy.ops.render.render(write_still=True)
    scene.render.engine, scene.render.use_compositing = "SHADOWCACHE", True
    return picture(bpy.context.view_layer.name)


def hybrid():
    bpy.ops.render.render(write_still=True)
    return picture("Composite")


def own_nodes():
    return [n for n in bpy.context.scene.node_tree.nodes if n.name.startswith(NAME)]


def is_same(what, found, wanted):
    means, rms = apart(found[:3], wanted[:3])
    print("case %s: means %.4f, tiles %.4f" % (what, means, rms))
    return means < MOST_MEAN and rms < MOST_TILES


def light():
    """All of Cycles' light is there once, and each part of the sum is seen to count."""
    scene = bpy.context.scene
    wanted = by_cycles()
    assert bpy.ops.shadowcache.hybrid() == {"FINISHED"}
    rest = scene.shadowcache.hybrid_rest
    assert rest.name == "Scene Cycles" and rest.cycles.max_bounces == 4 and not scene.shadowcache.hybrid_lamps
    rest.cycles.samples, rest.cycles.seed = 256, 7
    assert is_same("all", hybrid(), wanted)
    assert not sys.modules["shadowcache.engine"].LEFT_OUT[scene.name]
    tree = scene.node_tree
    group = next(n for n in own_nodes() if n.type == "GROUP")
    for name in ("Masked", "Cycles GlossDir", "DiffDir", "GlossDir"):
        link = group.inputs[name].links[0]
        ends = link.from_socket, link.to_socket
        tree.links.remove(link)
        assert not is_same("control without %s" % name, hybrid(), wanted), name
        tree.links.new(*ends)
    parts = sys.modules["shadowcache.hybrid"]
    plain, parts.lights_lamps = parts.lights_lamps, lambda of: False
    assert not is_same("control without the light of lamps", hybrid(), wanted)
    parts.lights_lamps = plain
    make_world(turn=(*TURN[:2], TURN[2] + 5))
    turned = hybrid()
    assert not is_same("control, map turned by 5 degrees", turned, wanted)
    assert is_same("map turned by 5 degrees, by both", turned, by_cycles())
    make_world(turn=TURN)


def lamps():
    """A lamp that this engine cannot light has Cycles light all of them, and a lamp that is dimmed is dimmed in both."""
    scene, lamp = bpy.context.scene, bpy.data.lights["lamp"]
    before = by_cycles()
    lamp.energy, lamp.color = 300, (1, 0.6, 0.3)
    dimmed = by_cycles()
    assert is_same("other power", hybrid(), dimmed) and not is_same("control, power of before", before, dimmed)
    lamp.cycles.cast_shadow = False
    shadowless = by_cycles()
    assert not is_same("control, lamp with a shadow", dimmed, shadowless)
    found = error_of(hybrid)
    assert "press Update, for light lamp: Cast Shadow is off" in found, found
    bpy.ops.shadowcache.hybrid()
    other = scene.shadowcache.hybrid_lamps
    assert other.name == "Scene Lamps" and other.cycles.max_bounces == 0 and len(own_nodes()) == 5
    other.cycles.seed = 7
    assert is_same("lamps by Cycles", hybrid(), shadowless)
    link = next(n for n in own_nodes() if n.type == "GROUP").inputs["Lamps DiffDir"].links[0]
    ends = link.from_socket, link.to_socket
    scene.node_tree.links.remove(link)
    assert not is_same("control without Lamps DiffDir", hybrid(), shadowless)
    scene.node_tree.links.new(*ends)
    lamp.cycles.cast_shadow = True
    assert is_same("lamps by Cycles that need not be", hybrid(), dimmed)
    bpy.ops.shadowcache.hybrid()
    assert not scene.shadowcache.hybrid_lamps and len(bpy.data.scenes) == 2 and len(own_nodes()) == 4
    assert is_same("lamps by this engine again", hybrid(), dimmed)
    lamp.energy, lamp.color = 80, (1, 1, 1)


def emitters():
    """What a masked material emits lights the set in Cycles alone."""
    scene, tree = bpy.context.scene, bpy.data.materials["Cube"].node_tree
    texture = tree.nodes.new("ShaderNodeTexChecker")
    texture.inputs["Color1"].default_value, texture.inputs["Color2"].default_value = (4, 1, 0, 1), (0, 0, 0, 1)
    plain = by_cycles()
    tree.links.new(texture.outputs["Color"], tree.nodes["Emission"].inputs["Color"])
    wanted = by_cycles()
    assert not is_same("control, an even emitter", plain, wanted)
    found = error_of(hybrid)
    assert "press Update, for Cube, material Cube" in found, found
    bpy.ops.shadowcache.hybrid()
    assert scene.shadowcache.hybrid_lamps
    scene.shadowcache.hybrid_lamps.cycles.seed = 7
    assert is_same("a checkered emitter", hybrid(), wanted)
    tree.nodes.remove(texture)
    bpy.ops.shadowcache.hybrid()
    assert not scene.shadowcache.hybrid_lamps


def film():
    """The scenes of Cycles have the scene's camera, size, film and filter."""
    scene, rest = bpy.context.scene, bpy.context.scene.shadowcache.hybrid_rest
    rest.cycles.samples *= 4  # the picture is small, so that its tiles show the noise
    scene.render.film_transparent = True
    scene.render.resolution_x, scene.render.resolution_y = 48, 48
    scene.shadowcache.filter, scene.shadowcache.filter_width = "gaussian", 3
    before = scene.camera
    scene.camera = before.copy()
    scene.camera.location.x -= 1
    scene.collection.objects.link(scene.camera)
    found = hybrid()
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "GAUSSIAN", 3
    wanted = by_cycles()
    assert found.shape == wanted.shape == (4, 48, 48) and is_same("film", found, wanted)
    difference = abs(found[3] - wanted[3])
    print("case alpha: at most %.4f apart" % difference.max())
    assert 0.2 < wanted[3].mean() < 0.98 and difference.max() < 0.05
    rest.cycles.samples //= 4
    bpy.data.objects.remove(scene.camera)
    scene.camera = before
    scene.render.film_transparent = False
    scene.render.resolution_x, scene.render.resolution_y = 64, 36
    scene.shadowcache.filter, scene.shadowcache.filter_width = "blackman-harris", 1.5
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BLACKMAN_HARRIS", 1.5


def animation():
    """Each frame has what moves where it is, also what shines, and the camera of its marker."""
    scene = bpy.context.scene
    thing, camera, shining = bpy.data.objects["Cube.001"], scene.camera, [bpy.data.objects[name] for name in ("Cube", "bulb")]
    places = [other.location.copy() for other in shining]
    other = camera.copy()
    other.location.x += 1
    scene.collection.objects.link(other)
    for frame, z, of in ((1, 0.8, camera), (2, 1.8, other)):
        thing.location.z = z
        thing.keyframe_insert("location", frame=frame)
        for lit in shining:
            lit.location.y -= 0.4
            lit.keyframe_insert("location", frame=frame)
        scene.timeline_markers.new(of.name, frame=frame).camera = of
    path, scene.frame_end = scene.render.filepath, 2
    found = error_of(hybrid)
    assert "press Update, for material Cube: emits and moves" in found, found
    bpy.ops.shadowcache.hybrid()
    scene.shadowcache.hybrid_lamps.cycles.seed = 7
    scene.render.filepath = os.path.join(WORK, "hybrid.####")
    bpy.ops.render.render(animation=True)
    scene.render.filepath = path
    frames = []
    for frame in (1, 2):
        scene.frame_set(frame)
        frames.append(by_cycles())
        found = picture("Composite", os.path.join(WORK, "hybrid.%04d.exr" % frame))
        assert is_same("frame %d" % frame, found, frames[-1])
    assert not is_same("control, another frame", *frames)
    scene.frame_set(1)
    scene.timeline_markers.clear()
    scene.camera = camera
    thing.animation_data_clear()
    for lit, place in zip(shining, places):
        lit.animation_data_clear()
        lit.location = place
    bpy.data.objects.remove(other)
    bpy.ops.shadowcache.hybrid()
    assert not scene.shadowcache.hybrid_lamps


def wires(tree):
    return sorted((link.from_node.name, link.from_socket.name, link.to_node.name) for link in tree.links)


def nodes():
    """Again and again there is one hybrid; nodes of the user stay, and have the render's picture in the end."""
    scene = bpy.context.scene
    bpy.ops.shadowcache.hybrid_remove()
    tree = scene.node_tree
    assert not own_nodes() and NAME not in bpy.data.node_groups and list(bpy.data.scenes) == [scene]
    gamma = tree.nodes.new("CompositorNodeGamma")
    tree.links.new(tree.nodes["Render Layers"].outputs["Image"], gamma.inputs["Image"])
    tree.links.new(gamma.outputs["Image"], tree.nodes["Composite"].inputs["Image"])
    before = wires(tree)
    bpy.ops.shadowcache.hybrid()
    made = wires(tree)
    assert (NAME, "Image", "Gamma") in made and ("Gamma", "Image", "Composite") in made, made
    assert ("Render Layers", "Image", "Gamma") not in made
    bpy.ops.shadowcache.hybrid()
    assert wires(tree) == made and len(own_nodes()) == 4 and len(bpy.data.scenes) == 2
    assert [g.name for g in bpy.data.node_groups] == [NAME]
    bpy.data.lights["lamp"].cycles.cast_shadow = False
    for _ in range(2):
        bpy.ops.shadowcache.hybrid()
        assert len(own_nodes()) == 5 and len(bpy.data.scenes) == 3
    bpy.data.lights["lamp"].cycles.cast_shadow = True
    bpy.ops.shadowcache.hybrid_remove()
    assert len(bpy.data.scenes) == 1
    assert wires(tree) == before
    bpy.ops.shadowcache.hybrid_remove()


def refusals():
    """Each says what is wrong: when a hybrid is made, and when it is rendered."""
    scene, press = bpy.context.scene, bpy.ops.shadowcache.hybrid

    def expect(words, action=press):
        found = error_of(action)
        assert words in found, found

    layer = scene.view_layers.new("second")
    expect("view layer second: expected one")
    scene.view_layers.remove(layer)
    scene.render.use_motion_blur = True
    expect("motion blur")
    scene.render.use_motion_blur = False
    thing = bpy.data.objects["Cube.001"]
    settings = thing.modifiers.new("hair", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.render_type = "HAIR", "PATH"
    expect("object Cube.001: hair")
    thing.modifiers.clear()
    thing.visible_shadow = False
    expect("object Cube.001: casts no shadow")
    thing.visible_shadow, thing.visible_glossy = True, False
    expect("object Cube.001: hidden from glossy rays")
    thing.visible_glossy = True
    tree = thing.active_material.node_tree
    clear = tree.nodes.new("ShaderNodeHoldout")
    tree.links.new(clear.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    expect("material Cube.001: Holdout")
    tree.nodes.remove(clear)
    fog = tree.nodes.new("ShaderNodeVolumePrincipled")
    tree.links.new(fog.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
    expect("material Cube.001: Volume")
    principled("Cube.001", Base_Color=(0.5, 0.5, 0.5, 1), Alpha=0.5)
    thing.active_material.cycles.use_transparent_shadow = False
    expect("material Cube.001: Alpha: Transparent Shadows is off")
    thing.active_material.cycles.use_transparent_shadow = True
    principled("Cube.001", Base_Color=(0.5, 0.5, 0.5, 1))
    assert not scene.shadowcache.hybrid_rest and not own_nodes(), "what is refused is made"

    press()
    shader = next(n for n in tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Clearcoat"].default_value = 1
    start = time.monotonic()
    scene.shadowcache.hybrid_rest.cycles.samples = 100000
    expect("press Update, for Cube.001", hybrid)
    assert time.monotonic() - start < 5, "Cycles renders what is refused"
    rest = scene.shadowcache.hybrid_rest.cycles
    rest.samples, rest.sample_clamp_indirect = 16, 0
    press()
    for name in ("lamp", "bulb", "Cube"):
        bpy.data.objects[name].hide_render = True
    plain = hybrid()[:3].mean()
    bpy.data.objects["lamp"].hide_render, bpy.data.objects["lamp"].visible_diffuse = False, False
    expect("press Update, for light lamp: hidden from diffuse rays", hybrid)
    bpy.data.objects["lamp"].hide_render, bpy.data.objects["lamp"].visible_diffuse = True, True
    bpy.context.view_layer.use_pass_diffuse_direct = False
    expect("press Update, for use_pass_diffuse_direct", hybrid)
    bpy.context.view_layer.use_pass_diffuse_direct = True
    make_world(turn=TURN, strength=3)
    assert abs(hybrid()[:3].mean() / plain - 3) < 0.02, "Cycles renders nothing after an error"
    other = scene.copy()
    bpy.context.window.scene = other
    expect("press Update, for its scene", bpy.ops.render.render)
    press()
    assert other.shadowcache.hybrid_rest.background_set == other != scene == scene.shadowcache.hybrid_rest.background_set
    bpy.ops.shadowcache.hybrid_remove()
    assert scene.shadowcache.hybrid_rest
    bpy.context.window.scene = scene
    bpy.data.scenes.remove(scene.shadowcache.hybrid_rest)
    expect("press Update, for its scene", hybrid)
    press()
    hybrid()


def state():
    """What a hybrid makes, and changes."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    return (sorted(s.name for s in bpy.data.scenes), sorted(g.name for g in bpy.data.node_groups), wires(scene.node_tree),
            bool(scene.shadowcache.hybrid_rest), [layer.use_pass_diffuse_direct, layer.use_pass_glossy_color])


def undo():
    """A step back there is no hybrid, a step on there is the same one again; so it is where it was removed."""
    bpy.ops.shadowcache.hybrid_remove()
    layer = bpy.context.view_layer
    layer.use_pass_diffuse_direct = layer.use_pass_glossy_color = False
    bpy.context.scene.cycles.samples = 16
    bpy.ops.ed.undo_push(message="before")
    before = state()
    bpy.ops.shadowcache.hybrid("EXEC_DEFAULT", True)  # as a user presses it
    made, wanted = state(), hybrid()
    assert made != before
    bpy.ops.ed.undo()
    assert state() == before, state()
    bpy.ops.render.render()
    bpy.ops.ed.redo()
    assert state() == made and (hybrid() == wanted).all()
    bpy.ops.shadowcache.hybrid_remove("EXEC_DEFAULT", True)
    removed = state()
    bpy.ops.ed.undo()
    assert state() == made != removed and (hybrid() == wanted).all()
    bpy.ops.ed.redo()
    assert state() == removed


def estimate():
    """Worth is that of the direct light, which is this engine's part."""
    found = sys.modules["shadowcache.estimate"].FOUND
    assert bpy.ops.shadowcache.estimate() == {"FINISHED"}
    said = next(iter(found.values()))
    print("case estimate: " + said)
    assert "The direct light of a frame takes " in said or "It does not pay: the direct light of a frame" in said, said


def main():
    install()
    make_rich()
    bpy.context.scene.render.engine = "SHADOWCACHE"
    bpy.context.scene.render.filepath = os.path.join(WORK, "hybrid.exr")
    for case in (light, estimate, lamps, emitters, film, animation, nodes, refusals, undo):
        start = time.monotonic()
        case()
        print("case %s: passed in %.1f s" % (case.__name__, time.monotonic() - start))
    print("all cases passed")


main()
