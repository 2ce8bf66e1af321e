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

        def export(depsgraph, set_frame):
            is_hybrid = hybrid.is_on(scene)
            state = set_file.update(depsgraph, set_frame, scene.shadowcache.use_motion, panes=not is_hybrid)
            camera = view.view_of(scene.camera.evaluated_get(depsgraph), scene)
            views = bake.Views({scene.frame_current: camera}, view.size_of(scene))
            # A hybrid's picture is half of it Cycles'.
            light = None if is_hybrid or set_file.all_moves() or not views.serves() else light_of(
                scene, depsgraph.view_layer, set_file.gains(state))
            return views, light

        views, light = with_render_depsgraph(export)
        self.wish = Wish(set_file, recipe, views, fps(scene), preferences.program_folder(), light,
                         picture_options(scene.shadowcache))
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
    light: object  # keys of the request environment or a world_map.Baking, and gains of lamps; None: worth is not asked
    picture: list  # options of shadowcache-render

    def text(self, should_stop):
        views = None if self.recipe.whole else self.views
        found = bake.estimate(self.set_file, self.recipe, views, self.rate, self.folder, should_stop)
        return text_of(found) + worth_text(found["seconds"], self._worth(should_stop))

    def _worth(self, should_stop):
        """What bake.worth() says, of a bake of this view; None where its spacing is not chosen by it."""
        if not self.light or self.recipe.spacing:
            return None
        world, gains = self.light
        light = light_options(world_map.keys_of(world, should_stop, lambda text: None))
        lamps = [word for gain in gains for word in ("--lamp", gain)]
        return bake.worth(self.set_file, self.recipe.quality, self.views, self.rate, [*light, *lamps, *self.picture],
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


def picture_options(settings):
    """Of a still picture; a noise target is no number of rays that a time could be told for."""
    rays = ["--samples", settings.samples, "--bounces", settings.bounces]
    if not settings.target_error:
        rays += ["--camera-rays", settings.camera_rays]
    return [str(word) for word in rays]


def text_of(found):
    return "The bake takes about %s min, %.3g MB on disk and %.2g GB of memory" % (
        bake.time_text(found["seconds"]), found["bytes"] / 1e6, found["memory_bytes"] / 1e9)


def worth_text(seconds, frame):
    """From which frame on a bake of so many seconds pays."""
    if not frame:
        return ""
    saved = frame["frame_without"] - frame["frame"]
    if saved <= 0:
        return ". It does not pay: a frame takes no less with it"
    return ". A frame takes %s with it, %s without for the same noise: it pays from frame %d on" % (
        bake.time_text(frame["frame"]), bake.time_text(frame["frame_without"]), max(1, math.ceil(seconds / saved)))
