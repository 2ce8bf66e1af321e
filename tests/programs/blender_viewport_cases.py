"""The viewport of the render engine in a Blender with a window, as blender_viewport.py starts it.

Each case is a generator that waits by `yield`: Blender's own loop goes on meanwhile, and draws.
"""

import math
import os
import sys
import time
import traceback

import bpy
import mathutils
import numpy

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import blender_exr  # noqa: E402
from blender_scene import TILE, WORK, apart, children, install, make_scene, make_world  # noqa: E402

MOST_MEAN, MOST_TILES = 0.01, 0.03
MOST_SECONDS = 0.3  # to the first picture
TIMEOUT = 30


def view(window=0):
    """Area, region, space and region data of the first 3D view in a window."""
    area = next(a for a in bpy.context.window_manager.windows[window].screen.areas if a.type == "VIEW_3D")
    region = next(r for r in area.regions if r.type == "WINDOW")
    return area, region, area.spaces.active, area.spaces.active.region_3d


def live():
    return list(sys.modules["shadowcache.viewport"].LIVE)


def until(condition, what):
    deadline = time.monotonic() + TIMEOUT
    while not condition():
        assert time.monotonic() < deadline, "%s: %s" % (what, [v.worker.status for v in live()])
        yield 0.01


def rested(what, count=1):
    """Waits until all views have drawn what they wish for."""
    yield 0.1  # for Blender to notice a change
    yield from until(lambda: len(live()) == count and all(
        v.worker.is_done and not v.wants_redraw() for v in live()), what)


def shown():
    """The pixels of the only view, rows from the top: (3, height, width)."""
    return live()[0].worker.rows[::-1, :, :3].transpose(2, 0, 1).astype(float)


def camera_like_view():
    """Makes the scene's camera and size those of the view."""
    _, region, _, data = view()
    scene, window = bpy.context.scene, data.window_matrix
    camera = scene.camera
    camera.matrix_world = data.view_matrix.inverted()
    camera.data.sensor_fit, camera.data.sensor_width, camera.data.clip_start = "HORIZONTAL", 36, 0.001
    long = max(region.width, region.height)
    camera.data.sensor_fit = "HORIZONTAL"
    if data.is_perspective:
        camera.data.type, camera.data.lens = "PERSP", 18 * window[0][0]
        camera.data.shift_x, camera.data.shift_y = window[0][2] / 2, window[1][2] / 2 * region.height / region.width
    else:
        camera.data.type, camera.data.ortho_scale = "ORTHO", 2 / window[0][0]
        camera.matrix_world = camera.matrix_world @ mathutils.Matrix.Translation((0, 0, 100))
        camera.data.shift_x, camera.data.shift_y = -window[0][3] / 2, -window[1][3] / 2 * region.height / region.width
    assert long == region.width
    scene.render.resolution_x, scene.render.resolution_y = region.width, region.height


def f12():
    """Linear planes of F12 (3, height, width)."""
    scene = bpy.context.scene
    scene.render.filepath = os.path.join(WORK, "picture.exr")
    bpy.ops.render.render(write_still=True)
    found = {name.split(".", 1)[1]: plane for name, plane in blender_exr.read(scene.render.filepath).items()}
    return numpy.stack([found["Combined." + c] for c in "RGB"]).astype(float)


def compare(what, found, wanted, same=True):
    height, width = (side // TILE * TILE for side in wanted.shape[1:])
    means, tiles = apart(found[:, :height, :width], wanted[:, :height, :width])
    print("case %s: means %.4f, tiles %.4f" % (what, means, tiles), flush=True)
    assert (means < MOST_MEAN and tiles < MOST_TILES) == same, "%s: means %.4f, tiles %.4f" % (what, means, tiles)


def screen():
    """The view's pixels on the screen, as they are seen: (3, height, width) from the top; not the outermost."""
    _, region, _, _ = view()
    path = os.path.join(WORK, "screen.png")
    bpy.ops.screen.screenshot(filepath=path)
    return png(path)[:, region.y:region.y + region.height, region.x:region.x + region.width][:, ::-1]


def png(path):
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Raw"
    pixels = numpy.empty(len(image.pixels), numpy.float32)
    image.pixels.foreach_get(pixels)
    width, height = image.size
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[:, :, :3].transpose(2, 0, 1).astype(float)


def said():
    """The status line of the only view."""
    return live()[0].error or live()[0].worker.status


def stamps():
    folder = bpy.context.scene.shadowcache.cache_folder
    return {os.path.join(path, name): os.stat(os.path.join(path, name)).st_mtime_ns
            for path, _, names in os.walk(folder) for name in names if name.endswith((".glb", ".vdb"))}


def first_picture():
    """Without a cache: shown, and nothing is baked."""
    area, region, space, data = view()
    space.overlay.show_overlays = space.show_gizmo = False
    space.show_region_toolbar = space.show_region_ui = space.show_region_header = space.show_region_tool_header = False
    bpy.context.scene.render.engine = "SHADOWCACHE"
    data.view_perspective = "PERSP"
    data.view_rotation, data.view_distance = mathutils.Euler((math.radians(65), 0, math.radians(10))).to_quaternion(), 9
    yield 0.2
    space.shading.type = "RENDERED"
    yield from rested("first picture")
    worker = live()[0].worker
    print("case status: " + said())
    assert said().endswith("no cache: F12 bakes it")
    assert worker.rows.shape == (region.height, region.width, 4)
    assert not any(name.endswith(".vdb") for name in stamps()), "a view has baked"


def like_f12():
    """After F12 the view takes its cache; its pixels and those on the screen are those of F12."""
    camera_like_view()
    wanted = f12()
    view()[0].tag_redraw()
    yield from rested("after F12")
    assert said() == "%d rays" % bpy.context.scene.shadowcache.viewport_rays, said()
    compare("view", shown(), wanted)
    yield 0.2
    path = os.path.join(WORK, "f12.png")
    scene = bpy.context.scene
    settings = scene.render.image_settings
    settings.file_format = "PNG"
    bpy.data.images["Render Result"].save_render(path, scene=scene)
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR_MULTILAYER", "32", "NONE"
    rows = slice(30, -30)  # the first ones have signs of the areas' corners
    compare("screen", screen()[:, rows], png(path)[:, ::-1][:, rows])
    data = view()[3]
    for degrees in (1, 5):
        data.view_rotation = mathutils.Euler((math.radians(65), 0, math.radians(10 + degrees))).to_quaternion()
        yield from rested("turned view")
        compare("control, view turned by %d degrees" % degrees, shown(), wanted, False)
    compare("control, screen", screen()[:, rows], png(path)[:, ::-1][:, rows], False)


def views():
    """Orthographic, and through a camera with zoom and offset: as F12 of a camera like that."""
    _, _, space, data = view()
    data.view_perspective = "ORTHO"
    yield from rested("orthographic")
    camera_like_view()
    compare("orthographic", shown(), f12())
    camera = bpy.context.scene.camera
    camera.data.type, camera.data.lens, camera.data.shift_x, camera.data.shift_y = "PERSP", 35, 0.1, -0.05
    camera.matrix_world = mathutils.Matrix.LocRotScale((0.5, -7, 3), mathutils.Euler((1.25, 0, 0.07)), None)
    data.view_perspective, data.view_camera_zoom, data.view_camera_offset = "CAMERA", 10, (0.05, 0.1)
    yield from rested("camera")
    found = shown()
    camera_like_view()
    data.view_perspective = "PERSP"
    compare("camera", found, f12())
    yield from rested("perspective")


def turns():
    """Sky and view turn at once, without anything written or loaded anew."""
    scene, data = bpy.context.scene, view()[3]
    process, before, worker = children(), stamps(), live()[0].worker
    mapping = next(n for n in scene.world.node_tree.nodes if n.type == "MAPPING")
    seconds = {"sky": [], "view": []}
    for i in range(6):
        for what in seconds:
            last = worker.first_seconds
            if what == "sky":
                mapping.inputs["Rotation"].default_value[2] += 0.3
            else:
                data.view_rotation = mathutils.Euler((1.1, 0, 0.1 * i)).to_quaternion()
            yield from until(lambda: worker.first_seconds != last, what)
            seconds[what].append(worker.first_seconds)
    yield from rested("turns")
    for what, times in seconds.items():
        print("case %s turned: first picture after %s s" % (what, ", ".join("%.2f" % t for t in times)))
        assert sorted(times)[len(times) // 2] < MOST_SECONDS, what
    camera_like_view()
    compare("sky turned", shown(), f12())
    mapping.inputs["Rotation"].default_value[2] += math.radians(5)
    wanted = shown()
    yield from rested("sky")
    compare("control, sky turned by 5 degrees", shown(), wanted, False)
    assert [p for p in process if p not in children()] == [] and stamps() == before, "a turn loads anew"


def moving():
    """While the view moves in each frame, pictures come."""
    data = view()[3]
    worker, serials, start = live()[0].worker, [], time.monotonic()
    for i in range(30):
        data.view_rotation = mathutils.Euler((1.1, 0, 0.02 * i)).to_quaternion()
        rows = worker.rows
        yield 0.05
        serials.append(worker.rows is not rows)
    print("case moving: %.1f pictures a second" % (sum(serials) / (time.monotonic() - start)))
    assert sum(serials) > 5
    yield from rested("after moving")


def edits():
    """A mesh that moves is exported to a file of the views, and is back after undo. F12's files stay."""
    before, wanted = stamps(), shown()
    bpy.ops.ed.undo_push(message="before")
    bpy.data.objects["Cube.002"].location.x += 0.7
    bpy.ops.ed.undo_push(message="moved")
    yield 0.4
    yield from rested("edit")
    print("case edited: " + said())
    assert "the cache is of another state of the set" in said()
    compare("edited", shown(), wanted, False)
    bpy.ops.ed.undo()
    yield 0.4
    yield from rested("undo")
    compare("undone", shown(), wanted)
    after = stamps()
    changed = [name for name in before if after[name] != before[name]]
    assert all("/viewport/" in name for name in changed), "a view writes the files of F12: %s" % changed


def images():
    """Another file, or other texels, of the world's image are another map; scripts must call update_tag() after
    foreach_set(). What a world leaves out is listed."""
    scene = bpy.context.scene
    write = sys.modules["shadowcache.exr"].write
    paths = [os.path.join(WORK, "flat%d.exr" % gain) for gain in (1, 2)]
    for gain, path in enumerate(paths, 1):
        write(path, numpy.full((4, 8, 3), 0.5 * gain, numpy.float32))
    make_world(image=paths[0])
    texture = next(n for n in scene.world.node_tree.nodes if n.type == "TEX_ENVIRONMENT")
    yield from rested("file")
    once = shown()
    texture.image.filepath = paths[1]
    yield from rested("another file")
    compare("another file", shown(), 2 * once)
    texture.image = bpy.data.images.new("flat", 8, 4, float_buffer=True)
    for what, gain in (("generated", 1), ("texels", 2), ("packed", 3), ("packed texels", 4)):
        texture.image.pixels.foreach_set([0.5 * gain] * 3 * 32 if texture.image.channels == 3 else
                                         [0.5 * gain, 0.5 * gain, 0.5 * gain, 1] * 32)
        texture.image.update_tag()  # as painting does
        if what == "packed":
            texture.image.pack()
        yield from rested(what)
        compare(what, shown(), gain * once)
    compare("control, packed texels", shown(), once, False)
    tree = scene.world.node_tree
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs[0], background.inputs["Strength"])
    left_out = sys.modules["shadowcache.engine"].LEFT_OUT
    yield from until(lambda: any("Light Path" in entry for entry in left_out[scene.name]), "left out")
    make_world(turn=(0, 0, 30))
    yield from rested("map again")
    assert not left_out[scene.name], left_out


def resize_and_windows():
    """Another size is no other process; a second window has one of its own, which ends with it."""
    process = set(children())
    area, region, _, _ = view()
    before = region.width
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.6)
    yield 0.2
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "VIEW_3D" and area != view()[0]:
            area.type = "OUTLINER"
    yield from rested("split")
    _, region, _, _ = view()
    assert region.width != before
    assert live()[0].worker.rows.shape[:2] == (region.height, region.width)
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=view()[0]):
        bpy.ops.wm.window_new()
    yield 0.5
    area = bpy.context.window_manager.windows[1].screen.areas[0]
    area.type = "VIEW_3D"
    area.spaces.active.shading.type = "RENDERED"
    yield from rested("two windows", 2)
    assert process < set(children()), "another size is another process"
    print("case two windows: %d processes" % len(children()))
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[1]):
        bpy.ops.wm.window_close()
    yield from rested("one window")


def killed():
    """A process that is gone is replaced, and an error is the status."""
    data = view()[3]
    for process in children():
        os.kill(process, 9)
    data.view_rotation = mathutils.Euler((1.0, 0, 0.1)).to_quaternion()
    yield from rested("killed")
    assert "rays" in said(), said()
    broken = os.path.join(WORK, "broken.exr")
    with open(broken, "wb") as file:
        file.write(b"\x76\x2f\x31\x01 no map")
    make_world(image=broken)
    yield from until(lambda: "broken.exr" in said(), "broken map")
    make_world(turn=(0, 0, 40))
    yield from rested("map")
    assert "rays" in said(), said()


def estimate():
    """By the button, while Blender goes on."""
    found = sys.modules["shadowcache.estimate"].FOUND
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
        assert bpy.ops.shadowcache.estimate("INVOKE_DEFAULT") == {"RUNNING_MODAL"}
    assert not found
    yield from until(lambda: found, "estimate")
    print("case estimate: " + next(iter(found.values())))
    yield from rested("after an estimate")


def job():
    """F12 as users press it, while the view is live."""
    bpy.context.preferences.view.render_display_type = "NONE"
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
        bpy.ops.render.render("INVOKE_DEFAULT")
    yield 0.1
    yield from until(lambda: not bpy.app.is_job_running("RENDER"), "job")
    view()[3].view_rotation = mathutils.Euler((1.0, 0, 0.3)).to_quaternion()
    yield from rested("after a job")
    bpy.ops.shadowcache.free()


def ends():
    """With the shading, and with the file."""
    _, _, space, _ = view()
    space.shading.type = "SOLID"
    yield from until(lambda: not children() and not live(), "shading ends")
    space.shading.type = "RENDERED"
    yield from rested("again")
    path = os.path.join(WORK, "reload.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)  # Blender opens files in Solid shading
    yield from until(lambda: not children() and not live(), "the file's end")
    view()[2].shading.type = "RENDERED"
    yield from rested("reload")
    assert len(children()) == 1
    left = [n for n in os.listdir("/dev/shm") if n.startswith("shadowcache-%d-" % os.getpid())]
    assert len(left) == 1, left


def all_cases():
    install()
    make_scene()
    make_world(turn=(0, 0, 30))
    settings = bpy.context.scene.shadowcache
    settings.viewport_rays = settings.camera_rays = settings.samples = 2
    settings.bake_scope = "SET"
    for case in (first_picture, like_f12, views, turns, moving, edits, images, resize_and_windows, killed, estimate, job, ends):
        start = time.monotonic()
        yield from case()
        print("case %s: passed in %.1f s" % (case.__name__, time.monotonic() - start), flush=True)
    print("all cases passed", flush=True)


def step(cases=all_cases()):
    try:
        return next(cases)
    except StopIteration:
        pass
    except BaseException:  # else Blender would stay
        traceback.print_exc()
    bpy.ops.wm.quit_blender()


bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(step, first_interval=0.5, persistent=True)
