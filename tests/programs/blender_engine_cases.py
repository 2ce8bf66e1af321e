"""The render engine in a real Blender, as blender_engine.py starts it: ZIP PROGRAMS MAP WORK.

Pictures are compared with those of Cycles, in the means and in tiles; turned worlds must be told apart.
"""

import math
import os
import sys
import time

import bpy
import mathutils
import numpy

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import blender_exr  # noqa: E402
from blender_scene import (DIM, PROGRAMS, SIZE, WORK, apart, children, error_of, install, make_scene,  # noqa: E402
                           make_world, preferences)

MOST_TILES = 0.011
MOST_SECONDS = 1.0  # of a cancelled render


class Layout:
    """Takes what a panel draws, and looks whether it exists."""

    def prop(self, data, name, **_):
        assert name in data.bl_rna.properties, "%s has no %s" % (data, name)

    def operator(self, name, **_):
        assert name.split(".")[1] in dir(getattr(bpy.ops, name.split(".")[0])), name

    def label(self, text="", icon="NONE"):
        assert text

    def row(self, **_):
        return self

    column = row


def panels():
    """Of this engine, and those of Blender that serve it."""
    module = sys.modules["shadowcache.panels"]
    bpy.context.scene.render.engine = "SHADOWCACHE"
    for kind in module.CLASSES:
        if kind.poll(bpy.context):
            kind.show(None, Layout(), bpy.context, bpy.context.scene.shadowcache)
    served = {kind.__name__ for kind in module.shared_panels()}
    assert {"RENDER_PT_color_management", "EEVEE_WORLD_PT_surface", "RENDER_PT_format"} <= served, served


def make_sky():
    make_world(image=None, tint=(1, 1, 1), strength=0.1)
    tree = bpy.context.scene.world.node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    sky.sky_type, sky.sun_elevation, sky.sun_rotation = "NISHITA", 0.6, 2.0
    sky.sun_size = math.radians(4)
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    tree.links.new(sky.outputs[0], background.inputs["Color"])


def render(engine):
    """Planes of a picture by channel; of layers alone."""
    render_settings = bpy.context.scene.render
    render_settings.engine = engine
    render_settings.filepath = os.path.join(WORK, "picture.exr")
    bpy.ops.render.render(write_still=True)
    return {name.split(".", 1)[1]: plane for name, plane in blender_exr.read(render_settings.filepath).items()}


def planes(picture, name, channels="RGB"):
    return numpy.stack([picture["%s.%s" % (name, c)] for c in channels]).astype(float)


def expect_same(what, found, wanted, most_mean=0.01, most_tiles=MOST_TILES):
    means, rms = apart(found, wanted)
    print("case %s: means %.4f, tiles %.4f" % (what, means, rms))
    assert means < most_mean and rms < most_tiles, "%s: means %.4f, tiles %.4f" % (what, means, rms)


def tells_worth(text):
    return "it pays from frame " in text or "It does not pay" in text


def estimated():
    """What the operator says."""
    found = sys.modules["shadowcache.estimate"].FOUND
    found.clear()
    assert bpy.ops.shadowcache.estimate() == {"FINISHED"}
    return found.popitem()[1]


def estimates():
    """Before there is a cache: what is said is what the bake then makes, for a frame and for the set."""
    settings = bpy.context.scene.shadowcache
    module = sys.modules["shadowcache.estimate"]
    make_world()
    for scope in ("SHOT", "SET"):
        settings.bake_scope = scope
        assert bpy.ops.shadowcache.estimate() == {"FINISHED"}
        assert not any(name.endswith(".vdb") for name in stamps()), "an estimate bakes"
    texts = list(module.FOUND.values())
    print("case estimates: %s" % texts)
    assert len(texts) == 2 and all("about 0:0" in text for text in texts), texts
    assert all(tells_worth(text) for text in texts), "with a spacing of one's own: %s" % texts
    megabytes = [float(text.split(" MB")[0].split()[-1]) for text in texts]
    settings.bake_scope = "SHOT"
    render("SHADOWCACHE")
    baked = next(os.path.getsize(os.path.join(settings.cache_folder, n)) for n in stamps() if n.endswith(".vdb"))
    assert abs(baked / 1e6 / megabytes[0] - 1) < 0.2 and megabytes[1] > megabytes[0], (baked, texts)
    settings.bake_spacing, spacing = 0, settings.bake_spacing
    said = estimated()
    print("case estimates: " + said)
    assert tells_worth(said), said
    settings.bake_spacing = spacing
    bpy.context.scene.frame_set(0)
    assert "not told of frames before 1" in estimated()
    bpy.context.scene.frame_set(1)
    panels()
    preferences().folder = "/nowhere"
    assert "no program shadowcache-bake there" in error_of(bpy.ops.shadowcache.estimate)
    preferences().folder = PROGRAMS


def worlds():
    """Direct light under each kind of world; the map turned by 1 and 5 degrees more must be told apart."""
    inverse = mathutils.Euler([math.radians(a) for a in (20, -35, 50)]).to_matrix().transposed().to_euler()
    back = [math.degrees(a) for a in inverse]
    cases = (("no mapping", {}), ("point", {"turn": (20, -35, 50)}), ("texture", {"turn": back, "kind": "TEXTURE"}),
             ("mirrored", {"turn": (0, 0, 30), "scale": (1, -1, 1)}),
             ("tint", {"turn": (0, 0, 90), "strength": 1.5, "tint": (1, 0.5, 0.25)}),
             ("colour", {"image": None, "tint": (0.5, 0.7, 1)}))
    for name, keys in cases:
        make_world(**keys)
        wanted = planes(render("CYCLES"), "Combined")
        expect_same(name, planes(render("SHADOWCACHE"), "Combined"), wanted)
        if name == "point":
            for more in (1, 5):
                make_world(turn=(20, -35, 50 + more))
                _, rms = apart(planes(render("SHADOWCACHE"), "Combined"), wanted)
                print("case control, %d degrees more: tiles %.4f" % (more, rms))
                assert rms > MOST_TILES, "the map turned by %d degrees more is not told apart" % more
    make_sky()
    wanted = planes(render("CYCLES"), "Combined")
    expect_same("sky texture", planes(render("SHADOWCACHE"), "Combined"), wanted)
    driven()
    make_world(turn=(0, 0, 0))
    wanted = planes(render("SHADOWCACHE"), "Combined")
    texture = next(node for node in bpy.context.scene.world.node_tree.nodes if node.type == "TEX_ENVIRONMENT")
    texture.texture_mapping.rotation[2] = 0.6  # no editor shows it
    found = planes(render("SHADOWCACHE"), "Combined")
    expect_same("mapping of the texture itself", found, planes(render("CYCLES"), "Combined"), most_tiles=0.03)  # resampled
    assert apart(found, wanted)[1] > 0.06, "the mapping of the texture itself does nothing"


def driven():
    """The strength of a world that Cycles makes a map of follows an object, which is not there then."""
    make_world(image=None, tint=(0.5, 0.7, 1))
    tree = bpy.context.scene.world.node_tree
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    gamma = tree.nodes.new("ShaderNodeGamma")
    gamma.inputs["Color"].default_value, gamma.inputs["Gamma"].default_value = (0.9, 0.5, 0.4, 1), 2
    tree.links.new(gamma.outputs[0], background.inputs["Color"])
    driver = background.inputs["Strength"].driver_add("default_value").driver
    variable = driver.variables.new()
    variable.type, variable.targets[0].id = "TRANSFORMS", bpy.context.scene.camera
    variable.targets[0].transform_type = "LOC_X"
    driver.expression = "0.4 * " + variable.name
    found = []
    for x in (0.5, 0.8):
        bpy.context.scene.camera.location.x = x
        found.append(planes(render("SHADOWCACHE"), "Combined"))
        expect_same("driven world, %g" % x, found[-1], planes(render("CYCLES"), "Combined"))
    assert apart(*found)[0] > 0.1
    bpy.context.scene.camera.location.x = 0.5


def all_passes():
    layer = bpy.context.view_layer
    flags = ["use_pass_" + name for name in ("z", "normal", "position", "diffuse_direct", "diffuse_color", "emit",
                                             "environment")]
    for flag in flags:
        setattr(layer, flag, True)
    layer.shadowcache.use_pass_variance = layer.cycles.denoising_store_passes = True
    make_world(turn=(20, -35, 50))
    wanted, found = render("CYCLES"), render("SHADOWCACHE")
    expect_same("DiffCol", planes(found, "DiffCol"), planes(wanted, "DiffCol"))
    # Where the sky has most of a pixel, what is left for the surface is noise.
    lit, light = (planes(p, "DiffDir") * planes(p, "DiffCol") for p in (found, wanted))
    expect_same("DiffDir", lit, light)
    far, sky = found["Depth.Z"] > 1e9, wanted["Depth.Z"] > 1e9
    print("case sky: %.4f of Cycles' pixels" % (far == sky).mean())
    assert far.any() and (far == sky).mean() > 0.97
    for name, channels in (("Depth", "Z"), ("Position", "XYZ"), ("Normal", "XYZ")):
        difference = abs(planes(found, name, channels) - planes(wanted, name, channels))[:, ~(far | sky)]
        print("case %s: median difference %.5f" % (name, numpy.median(difference)))
        # Cycles takes a random place of the pixel, which may be on another surface.
        assert numpy.median(difference) < 0.02 and (difference < 0.3).mean() > 0.9, name
    assert found["Noise Variance.Y"].max() > 0
    denoising(found)
    expect_same("Env", planes(found, "Env"), planes(wanted, "Env"))
    strength = bpy.data.materials["Cube"].node_tree.nodes["Emission"].inputs["Strength"]
    strength.default_value = 1
    expect_same("Emit", planes(render("SHADOWCACHE"), "Emit"), planes(render("CYCLES"), "Emit"))
    strength.default_value = DIM
    for flag in flags:
        setattr(layer, flag, False)
    layer.shadowcache.use_pass_variance = layer.cycles.denoising_store_passes = False


def denoising(found):
    """The passes of Denoising Data, by Cycles' names."""
    albedo = planes(found, "Denoising Albedo")
    assert numpy.allclose(albedo, planes(found, "DiffCol"), atol=1e-6), "of surfaces without gloss"
    assert (planes(found, "Noisy Image") == planes(found, "Combined")).all()
    assert (planes(found, "Denoising Normal", "XYZ") == planes(found, "Normal", "XYZ")).all()
    assert (found["Denoising Depth.Z"] >= 0).all() and found["Denoising Depth.Z"].max() > 1


def add_lamps():
    lamps = []
    for name, place, energy in (("Key", (2, -3, 3), 300), ("Fill", (-3, -2, 2), 200), ("Rim", (0, 4, 3), 150)):
        lamp = bpy.data.objects.new(name, bpy.data.lights.new(name, "POINT"))
        lamp.location, lamp.data.energy, lamp.data.shadow_soft_size = place, energy, 0.3
        bpy.context.scene.collection.objects.link(lamp)
        lamps.append(lamp)
    return lamps


def dimmed():
    """Lamps are dimmed and coloured without an export, a bake or a load; from black they are exported."""
    lamps = add_lamps()
    make_world()
    folder = bpy.context.scene.shadowcache.cache_folder
    first = planes(render("SHADOWCACHE"), "Combined")
    before = stamps()
    lamps[0].data.energy *= 0.5
    lamps[1].data.color = (0.2, 1, 0.4)
    lamps[2].data.energy = 0
    changed = planes(render("SHADOWCACHE"), "Combined")
    assert stamps() == before, "a dimmed lamp exports"
    for name in os.listdir(folder):
        if name.endswith(".json"):
            os.remove(os.path.join(folder, name))
    exported = planes(render("SHADOWCACHE"), "Combined")
    assert stamps() != before
    expect_same("dimmed", changed, exported)
    assert apart(changed, first)[0] > 0.05
    before = stamps()
    lamps[2].data.energy = 150
    lit = planes(render("SHADOWCACHE"), "Combined")
    assert stamps() != before and apart(lit, exported)[0] > 0.02
    for lamp in lamps:
        bpy.data.objects.remove(lamp)


def light_groups():
    """Passes Combined_NAME beside those of Cycles; with a control that must be told apart."""
    scene, layer, lamps = bpy.context.scene, bpy.context.view_layer, add_lamps()
    for name in ("lamps", "day", "none"):
        layer.lightgroups.add(name=name)
    make_world()
    lamps[0].lightgroup = lamps[1].lightgroup = "lamps"
    scene.world.lightgroup = "day"
    wanted, found = render("CYCLES"), render("SHADOWCACHE")
    for name in ("Combined_lamps", "Combined_day"):
        expect_same(name, planes(found, name), planes(wanted, name), most_tiles=2 * MOST_TILES)  # Cycles' noise
    assert not planes(found, "Combined_none").any()
    # Rim and what emits are in no group.
    rest = planes(found, "Combined") - planes(found, "Combined_lamps") - planes(found, "Combined_day")
    assert rest.min() > -1e-4 and rest.mean() > 0.01 * planes(found, "Combined").mean()
    lamps[1].lightgroup = ""
    assert apart(planes(render("SHADOWCACHE"), "Combined_lamps"), planes(wanted, "Combined_lamps"))[0] > 0.1
    for lamp in lamps:
        bpy.data.objects.remove(lamp)
    while layer.lightgroups:
        bpy.ops.scene.view_layer_remove_lightgroup()
    scene.world.lightgroup = ""


def noise_target():
    """The error of a picture, by two of other seeds, is about the target; the light stays."""
    settings = bpy.context.scene.shadowcache
    make_world()
    wanted = planes(render("CYCLES"), "Combined")
    for target in (1e-3, 1e-4):
        settings.target_error = target
        pictures = []
        for settings.seed in (1, 2):
            pictures.append(planes(render("SHADOWCACHE"), "Combined"))
        mean = sum(pictures) / 2
        error = ((pictures[0] - pictures[1]) ** 2 / 2 / (mean ** 2 + 0.01 * mean.mean() ** 2)).mean()
        print("case noise target %g: %.6f" % (target, error))
        assert target / 3 < error < 3 * target
    expect_same("noise target", mean, wanted)
    settings.target_error = 0
    settings.seed = 1


def film():
    """Alpha is that of Cycles; a border has the pixels of the whole picture."""
    settings = bpy.context.scene.render
    make_world()
    settings.film_transparent = True
    wanted, found = render("CYCLES"), render("SHADOWCACHE")
    expect_same("transparent", planes(found, "Combined", "RGBA"), planes(wanted, "Combined", "RGBA"))
    settings.film_transparent = False
    whole = planes(render("SHADOWCACHE"), "Combined")
    settings.use_border = settings.use_crop_to_border = True
    settings.border_min_x, settings.border_max_x, settings.border_min_y, settings.border_max_y = 0.3, 0.71, 0.2, 0.6
    part = planes(render("SHADOWCACHE"), "Combined")
    settings.use_border = settings.use_crop_to_border = False
    left, bottom = int(0.3 * SIZE[0]), int(0.2 * SIZE[1])
    top = SIZE[1] - bottom - part.shape[1]
    assert (part == whole[:, top:top + part.shape[1], left:left + part.shape[2]]).all(), "a border has other pixels"


def stamps():
    folder = bpy.context.scene.shadowcache.cache_folder
    return {name: os.stat(os.path.join(folder, name)).st_mtime_ns for name in os.listdir(folder)
            if name.endswith((".glb", ".vdb"))}


def animation():
    """Where the camera alone moves the set is exported and baked once; what moves besides is rendered where it is."""
    scene = bpy.context.scene
    camera = scene.camera
    for frame, x in ((1, 0.5), (3, 1.5)):
        camera.location.x = x
        camera.keyframe_insert("location", frame=frame)
    scene.render.engine = "SHADOWCACHE"
    scene.render.filepath = os.path.join(WORK, "frame.####")
    before = stamps()
    bpy.ops.render.render(animation=True)
    after = stamps()
    assert [n for n in after if n.endswith(".glb") and after[n] != before[n]] == [], "a camera exports the set"
    bpy.ops.render.render(animation=True)
    assert stamps() == after, "frames that were baked for are baked for again"
    camera.animation_data_clear()
    thing = bpy.data.objects["Cube.001"]
    tree = scene.world.node_tree
    strength = next(node for node in tree.nodes if node.type == "BACKGROUND").inputs["Strength"]
    for frame, z, light in ((1, 0.8, 1), (3, 1.8, 2)):
        thing.location.z, strength.default_value = z, light
        thing.keyframe_insert("location", frame=frame)
        strength.keyframe_insert("default_value", frame=frame)
    scene.frame_set(1)
    bpy.ops.render.render(animation=True)
    moved = stamps()
    scene.frame_set(3)
    wanted = planes(render("CYCLES"), "Combined")
    found = {n.split(".", 1)[1]: p for n, p in blender_exr.read(os.path.join(WORK, "frame.0003.exr")).items()}
    expect_same("frame 3 of a moving object under a brighter sky", planes(found, "Combined"), wanted)
    render("SHADOWCACHE")
    assert {n: t for n, t in stamps().items() if n.endswith(".glb")} == \
        {n: t for n, t in moved.items() if n.endswith(".glb")}, "a frame of a known motion exports the set"
    scene.frame_set(1)
    thing.animation_data_clear()
    tree.animation_data_clear()


def all_moves():
    """There is nothing to bake, and an estimate says so."""
    things = [thing for thing in bpy.data.objects if thing.type == "MESH"]
    places = [thing.location.copy() for thing in things]
    for thing in things:
        for frame in (1, 3):
            thing.location.z += 0.1
            thing.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(2)
    bpy.context.scene.frame_set(1)
    said = estimated()
    assert said == "There is no bake: all of the set moves", said
    for thing, place in zip(things, places):
        thing.animation_data_clear()
        thing.location = place


def stale():
    """A set that has changed is baked again, or rendered with its stale cache: both are right."""
    thing = bpy.data.objects["Cube.002"]
    render("SHADOWCACHE")
    before = stamps()
    thing.location.x += 0.7
    bpy.context.scene.shadowcache.stale = "USE"
    found = render("SHADOWCACHE")
    wanted = render("CYCLES")
    expect_same("stale cache", planes(found, "Combined"), planes(wanted, "Combined"))
    used = stamps()
    assert [n for n in used if used[n] != before[n]] == [n for n in used if n.endswith(".glb")]
    bpy.context.scene.shadowcache.stale = "BAKE"
    expect_same("baked again", planes(render("SHADOWCACHE"), "Combined"), planes(wanted, "Combined"))
    assert all(stamps()[n] != used[n] for n in used if n.endswith(".vdb")), "a stale cache was not baked again"


def first_picture():
    """A picture is shown before a bake, and only then."""
    frame, bake = sys.modules["shadowcache.frame"].Frame, sys.modules["shadowcache.bake"]
    before, events = (frame._picture, bake.bake), []

    def picture(self, reply):
        events.append("picture")
        return before[0](self, reply)

    def baked(*words):
        events.append("bake")
        return before[1](*words)

    settings = bpy.context.scene.shadowcache
    spacing, settings.bake_spacing = settings.bake_spacing, 0.37
    frame._picture, bake.bake = picture, baked
    try:
        render("SHADOWCACHE")
        assert events[:3] == ["picture", "bake", "picture"], events
        events.clear()
        render("SHADOWCACHE")
        assert events and "bake" not in events, events
    finally:
        frame._picture, bake.bake = before
        settings.bake_spacing = spacing


def errors():
    """Our sentence is the operator's."""
    preferences().folder = "/nowhere"
    assert "no program shadowcache-render there" in error_of(lambda: render("SHADOWCACHE"))
    preferences().folder = PROGRAMS
    broken = os.path.join(WORK, "broken.exr")
    with open(broken, "wb") as file:
        file.write(b"\x76\x2f\x31\x01 no map")
    make_world(image=broken)
    assert "broken.exr" in error_of(lambda: render("SHADOWCACHE"))
    make_world(turn=(0, 0, 0))
    tree = bpy.context.scene.world.node_tree
    follows = tree.nodes["Texture Coordinate"]
    follows.object = bpy.data.objects["Cube"]
    tree.links.new(follows.outputs["Object"], tree.nodes["Mapping"].inputs["Vector"])
    assert "follows the object Cube" in error_of(lambda: render("SHADOWCACHE"))
    make_world()
    camera, bpy.context.scene.camera.data.type = bpy.context.scene.camera, "PANO"
    assert "expected perspective or orthographic" in error_of(lambda: render("SHADOWCACHE"))
    camera.data.type = "PERSP"
    for process in children():
        os.kill(process, 9)
    render("SHADOWCACHE")  # by a new one


def killed():
    """The process that renders is killed in the middle of it."""
    kind = sys.modules["shadowcache.frame"].Frame
    before = kind._say

    def say(self, text, share=None):
        if text.startswith("Render: "):
            for process in children():
                os.kill(process, 9)

    sys.modules["shadowcache.engine"].RESIDENT.close()
    settings = bpy.context.scene.shadowcache
    settings.camera_rays, kind._say = 4096, say
    try:
        assert "shadowcache-render has ended with status -9" in error_of(lambda: render("SHADOWCACHE"))
    finally:
        settings.camera_rays, kind._say = 64, before
    assert not children()
    render("SHADOWCACHE")


def cancel():
    """In each of its steps a render ends within a second, without a child."""
    kind = sys.modules["shadowcache.frame"].Frame  # Blender itself hears of no Esc here
    before = kind._say, kind._stopped
    settings = bpy.context.scene.shadowcache
    state = {}

    def say(self, text, share=None):
        if text.startswith(state["step"]):
            state.setdefault("from", time.monotonic() + state["after"])

    def stopped(self):
        if time.monotonic() < state.get("from", state["start"] + 20):
            return False
        state.setdefault("asked", time.monotonic())
        return True

    kind._say, kind._stopped = say, stopped
    settings.camera_rays = 65536
    try:
        for step, after in (("Export", 0), ("Bake", 0.5), ("Load", 0), ("World", 0), ("Render", 0.5)):
            settings.bake_spacing, settings.bake_scope = (0.02, "SET") if step == "Bake" else (0.5, "SHOT")
            if step == "World":
                make_world(image=os.path.join(WORK, "big.hdr"))
            state.clear()
            state.update(step=step, after=after, start=time.monotonic())
            render("SHADOWCACHE")
            ended = time.monotonic()
            assert "from" in state and "asked" in state, "%s: it did not come to that" % step
            print("case cancel in %s: %.2f s" % (step, ended - state["asked"]))
            assert ended - state["asked"] < MOST_SECONDS, step
            assert not children(), "%s: a child is left" % step
            left = [n for n in os.listdir(settings.cache_folder) if ".part" in n or "checkpoint" in n]
            assert not left, "%s leaves %s" % (step, left)
    finally:
        kind._say, kind._stopped = before
    settings.camera_rays = 64
    make_world()


def memory_of(process):
    with open("/proc/%d/status" % process, encoding="ascii") as file:
        return int(next(line for line in file if line.startswith("VmRSS:")).split()[1])


def flat_memory():
    """Of Blender and of one process, over fifty frames; a cache of a shot would be extended, and the process another."""
    settings = bpy.context.scene.shadowcache
    settings.camera_rays, settings.bake_scope = 1, "SET"
    render("SHADOWCACHE")
    process = children()
    for i in range(54):
        bpy.context.scene.camera.location.z += 0.01
        make_world(turn=(0, 0, i))
        render("SHADOWCACHE")
        assert children() == process, "a frame has another process"
        found = memory_of(os.getpid()), memory_of(process[0])
        if i == 3:
            before = found
    print("case memory: %s kB, %s kB before fifty frames" % (found, before))
    assert all(now - then < 10000 for now, then in zip(found, before))
    bpy.ops.shadowcache.free()
    assert not children()


def main():
    install()
    make_scene()
    for case in (panels, estimates, worlds, all_passes, light_groups, dimmed, noise_target, film, animation, all_moves, stale, first_picture,
                 errors, killed, cancel, flat_memory):
        start = time.monotonic()
        case()
        print("case %s: passed in %.1f s" % (case.__name__, time.monotonic() - start))
    print("all cases passed")


main()
