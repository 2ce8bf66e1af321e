# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine: F12, animations and the viewport."""

import bpy

from . import hybrid, passes, view, viewport
from .child import Cancelled, Failed
from .frame import Frame, Job
from .programs import Missing
from .session import Session

ID = "SHADOWCACHE"
RESIDENT = Session()   # of final renders; the process stays between them
# What the last frame of each scene left out, by the scene's name.
LEFT_OUT = {}
job = Job()


class ShadowcacheEngine(bpy.types.RenderEngine):
    bl_idname = ID
    bl_label = "Shadowcache"
    bl_use_preview = False
    bl_use_postprocess = True
    bl_use_shading_nodes_custom = False
    bl_use_eevee_viewport = True
    bl_use_gpu_context = False
    shown = None  # the Viewport of an instance that is a 3D view's

    def update_render_passes(self, scene, layer):
        self.register_pass(scene, layer, "Combined", 4, "RGBA", "COLOR")
        for p in passes.wanted(layer):
            self.register_pass(scene, layer, p.name, len(p.channels), p.channels, p.kind)

    def render(self, depsgraph):
        # Whatever happens, Blender gets a result: without one it may crash where it saves the picture.
        region = view.region_of(depsgraph.scene)
        result = self.begin_result(0, 0, region["width"], region["height"], layer=depsgraph.view_layer.name)
        try:
            self._render(depsgraph, result)
        except Cancelled:
            RESIDENT.close()
        except (Failed, Missing, OSError, ValueError) as error:
            hybrid.hold(depsgraph.scene.original)
            self.report({"ERROR"}, str(error))
        finally:
            self.end_result(result)

    def _render(self, depsgraph, result):
        frame = Frame(self, depsgraph, RESIDENT, job)
        layer = result.layers[0]

        def show(picture):
            picture.fill(layer, frame.wanted)
            self.update_result(result)

        frame.render(show).fill(layer, frame.wanted)
        self._report_left_out(depsgraph.scene.name, frame.left_out)

    def _live_viewport(self):
        if self.shown not in viewport.LIVE:
            self.shown = viewport.Viewport()
        return self.shown

    def view_update(self, context, depsgraph):
        self._live_viewport().update(depsgraph)

    def view_draw(self, context, depsgraph):
        shown = self._live_viewport()
        shown.draw(self, context, depsgraph)
        if shown.left_out is not None:
            LEFT_OUT[depsgraph.scene.name] = shown.left_out

    def __del__(self):
        if self.shown:
            self.shown.close()

    def _report_left_out(self, name, entries):
        entries = list(dict.fromkeys(entries))
        LEFT_OUT[name] = entries
        if entries and entries != job.left_out:
            self.report({"WARNING"}, "not rendered: " + "; ".join(entries))
        job.left_out = entries


@bpy.app.handlers.persistent
def begin_job(*_):
    global job
    job = Job()


@bpy.app.handlers.persistent
def free(*_):
    """Ends the resident processes, and forgets what they have shown."""
    RESIDENT.close()
    viewport.close_all()
    LEFT_OUT.clear()


def register():
    bpy.utils.register_class(ShadowcacheEngine)
    bpy.app.handlers.render_init.append(begin_job)
    bpy.app.handlers.load_pre.append(free)


def unregister():
    free()
    bpy.app.handlers.load_pre.remove(free)
    bpy.app.handlers.render_init.remove(begin_job)
    bpy.utils.unregister_class(ShadowcacheEngine)
