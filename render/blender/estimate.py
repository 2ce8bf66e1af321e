# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator that says what a bake will take before it begins."""

import math
import threading
from dataclasses import dataclass

import bpy

from . import bake, folders, hybrid, preferences, view, world_map
from .blender_export.render_depsgraph import with_render_depsgraph
from .child import Cancelled, Failed
from .programs import Missing
from .set_file import fps

INTERVAL = 0.1  # seconds between looks whether it is done
ALL_MOVES = "There is no bake: all of the set moves"
NO_VIEW = ". From which frame it pays is not told of frames before 1"
# The last one of each set and its bake's options, as a text.
FOUND = {}


def key_of(set_file, recipe):
    return set_file.path, recipe.whole, tuple(recipe.options())


class SHADOWCACHE_OT_estimate(bpy.types.Operator):
    """Bake a small sample of what the bake of this frame, or of the set, needs, and tell what the whole takes"""
    bl_idname = "shadowcache.estimate"
    bl_label = "Estimate"

    @classmethod
    def poll(cls, context):
        return context.scene.camera is not None and not bpy.app.is_job_running("RENDER")

    def _start(self, context):
        """Exports the set, and lets a thread do the rest; whether it could."""
        try:
            self._export(context)
        except (Failed, OSError, ValueError, RuntimeError) as error:
            self.report({"ERROR"}, str(error))
            return False
        return True

    def _export(self, context):
        scene, layer = context.scene, context.view_layer.name
        set_file, recipe = folders.set_file_of(scene, layer), bake.Recipe(scene.shadowcache)
        is_hybrid = hybrid.is_on(scene)  # before the export's render, which goes without the compositor
        lights_lamps = not is_hybrid or hybrid.lights_lamps(scene)

        def export(depsgraph, set_frame):
            state = set_file.update(depsgraph, set_frame, scene.shadowcache.use_motion, panes=not is_hybrid)
            camera = view.view_of(scene.camera.evaluated_get(depsgraph), scene)
            views = bake.Views({scene.frame_current: camera}, view.size_of(scene))
            return views, light_of(scene, depsgraph.view_layer, set_file.gains(state) if lights_lamps else [])

        views, light = with_render_depsgraph(export)
        self.wish = Wish(set_file, recipe, views, fps(scene), preferences.program_folder(), light,
                         picture_options(scene.shadowcache, is_hybrid, lights_lamps), is_hybrid)
        self.stop, self.error, self.result = threading.Event(), "", ""
        self.key = key_of(set_file, recipe)
        self.thread = threading.Thread(target=self._run)
        self.thread.start()

    def _run(self):
        try:
            self.result = self.wish.text(self.stop.is_set)
        except Cancelled:
            pass
        except (Failed, Missing, OSError, ValueError) as error:
            self.error = str(error)

    def _end(self):
        self.thread.join()
        if self.error:
            self.report({"ERROR"}, self.error)
        if not self.result:
            return {"CANCELLED"}
        FOUND[self.key] = self.result
        self.report({"INFO"}, FOUND[self.key])
        return {"FINISHED"}

    def execute(self, context):
        return self._end() if self._start(context) else {"CANCELLED"}

    def invoke(self, context, event):
        if not self._start(context):
            return {"CANCELLED"}
        self.timer = context.window_manager.event_timer_add(INTERVAL, window=context.window)
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set("Shadowcache estimates the bake. Esc: stop")
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self.stop.set()
        if self.thread.is_alive():
            return {"PASS_THROUGH"}
        context.window_manager.event_timer_remove(self.timer)
        context.workspace.status_text_set(None)
        for area in context.screen.areas:
            area.tag_redraw()
        return self._end()


@dataclass
class Wish:
    """What is to be estimated: plain data, which the thread reads."""
    set_file: object
    recipe: object
    views: object
    rate: float
    folder: str
    light: object  # keys of the request environment or a world_map.Baking, and gains of lamps
    picture: list  # options of shadowcache-render
    is_hybrid: bool

    def text(self, should_stop):
        if self.set_file.all_moves():
            return ALL_MOVES
        views = None if self.recipe.whole else self.views
        found = bake.estimate(self.set_file, self.recipe, views, self.rate, self.folder, should_stop)
        if not self.views.serves():
            return text_of(found) + NO_VIEW
        return text_of(found) + worth_text(found["seconds"], self._worth(should_stop), self.is_hybrid)

    def _worth(self, should_stop):
        """What bake.worth() says, of a bake of this view."""
        world, gains = self.light
        light = light_options(world_map.keys_of(world, should_stop, lambda text: None))
        lamps = [word for gain in gains for word in ("--lamp", gain)]
        return bake.worth(self.set_file, self.recipe, self.views, self.rate, [*light, *lamps, *self.picture],
                          self.folder, should_stop)


def light_of(scene, layer, gains):
    """World and gains of lamps, as Wish has them."""
    light, _ = world_map.light_of(scene, layer, folders.folder_of(scene))
    if isinstance(light, world_map.Baking):
        light.prepare(scene.world)
    return light, gains or []


def light_options(fields):
    """Options of shadowcache-render that say what keys of the request environment say."""
    options = ["--env", fields["map"] if "map" in fields else numbers(fields["radiance"])]
    for key in ("rotate", "gain"):
        if key in fields:
            options.append("--env-%s=%s" % (key, numbers(fields[key])))
    return options


def numbers(value):
    return ",".join(repr(float(number)) for number in (value if hasattr(value, "__len__") else [value]))


def picture_options(settings, is_hybrid, lights_lamps):
    """Of a still picture; a noise target is no number of rays that a time could be told for. Of a hybrid: of the light
    that Cycles leaves to this engine. lights_lamps: that of lamps and emitters, too."""
    rays = ["--samples", settings.samples, "--bounces", 0 if is_hybrid else settings.bounces]
    if not lights_lamps:
        rays += ["--lamps", "off"]
    if not settings.target_error:
        rays += ["--camera-rays", settings.camera_rays]
    return [str(word) for word in rays]


def text_of(found):
    return "The bake takes about %s min, %.3g MB on disk and %.2g GB of memory" % (
        bake.time_text(found["seconds"]), found["bytes"] / 1e6, found["memory_bytes"] / 1e9)


def worth_text(seconds, frame, is_hybrid):
    """From which frame on a bake of so many seconds pays."""
    what = "The direct light of a frame" if is_hybrid else "A frame"
    saved = frame["frame_without"] - frame["frame"]
    if saved <= 0:
        return ". It does not pay: %s takes no less with it" % (what[0].lower() + what[1:])
    return ". %s takes %s with it, %s without for the same noise: it pays from frame %d on" % (
        what, bake.time_text(frame["frame"]), bake.time_text(frame["frame_without"]), max(1, math.ceil(seconds / saved)))
