# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators of the panel Hybrid."""

import bpy

from . import folders, hybrid, hybrid_check
from .blender_export.render_depsgraph import with_render_depsgraph


class SHADOWCACHE_OT_hybrid(bpy.types.Operator):
    """Make scenes and compositor nodes, or bring them up to date: direct light by Shadowcache, the rest by Cycles"""
    bl_idname = "shadowcache.hybrid"
    bl_label = "Make Hybrid"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.scene.camera is not None and not bpy.app.is_job_running("RENDER")

    def execute(self, context):
        scene, layer = context.scene, context.view_layer

        def look(depsgraph, set_frame):
            set_file = folders.set_file_of(scene, layer.name)
            state = set_file.update(depsgraph, set_frame, scene.shadowcache.use_motion, panes=False)
            return hybrid_check.needs_of(depsgraph, set_file.left_out(state), set_file.path)

        try:
            hybrid.make(scene, layer, with_render_depsgraph(look))
        except (OSError, ValueError, RuntimeError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class SHADOWCACHE_OT_hybrid_remove(bpy.types.Operator):
    """Remove the scenes and compositor nodes of the hybrid"""
    bl_idname = "shadowcache.hybrid_remove"
    bl_label = "Remove"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return not bpy.app.is_job_running("RENDER")

    def execute(self, context):
        hybrid.remove(context.scene)
        return {"FINISHED"}


CLASSES = (SHADOWCACHE_OT_hybrid, SHADOWCACHE_OT_hybrid_remove)
