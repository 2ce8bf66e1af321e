# SPDX-License-Identifier: GPL-3.0-or-later
"""The operator that says what a bake will take before it begins."""

import threading

import bpy

from . import bake, folders, hybrid, preferences, view
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
            set_file.update(depsgraph, set_frame, scene.shadowcache.use_motion, panes=not hybrid.is_on(scene))
            camera = view.view_of(scene.camera.evaluated_get(depsgraph), scene)
            return bake.Views({scene.frame_current: camera}, view.size_of(scene))

        views = with_render_depsgraph(export)
        words = set_file, recipe, None if recipe.whole else views, fps(scene), preferences.program_folder()
        self.stop, self.error, self.result = threading.Event(), "", None
        self.key = key_of(set_file, recipe)
        self.thread = threading.Thread(target=self._run, args=words)
        self.thread.start()

    def _run(self, *words):
        try:
            self.result = bake.estimate(*words, self.stop.is_set)
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
        FOUND[self.key] = text_of(self.result)
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


def text_of(found):
    return "The bake takes about %s min, %.3g MB on disk and %.2g GB of memory" % (
        bake.time_text(found["seconds"]), found["bytes"] / 1e6, found["memory_bytes"] / 1e9)
