# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators of the panels."""

import bpy

from . import bake, engine, estimate, folders, hybrid_operators


class SHADOWCACHE_OT_free(bpy.types.Operator):
    """End the resident process, which holds the set and the cache between renders"""
    bl_idname = "shadowcache.free"
    bl_label = "Free Memory"

    @classmethod
    def poll(cls, context):
        return engine.RESIDENT.server is not None and not bpy.app.is_job_running("RENDER")

    def execute(self, context):
        engine.RESIDENT.close()
        return {"FINISHED"}


class SHADOWCACHE_OT_forget(bpy.types.Operator):
    """Remove the cache of this view layer, so that the next render bakes it anew"""
    bl_idname = "shadowcache.forget"
    bl_label = "Remove Cache"

    @classmethod
    def poll(cls, context):
        return not bpy.app.is_job_running("RENDER")

    def execute(self, context):
        engine.RESIDENT.close()
        bake.forget(folders.set_file_of(context.scene, context.view_layer.name))
        return {"FINISHED"}


CLASSES = (SHADOWCACHE_OT_free, SHADOWCACHE_OT_forget, estimate.SHADOWCACHE_OT_estimate, *hybrid_operators.CLASSES)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)


def unregister():
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
