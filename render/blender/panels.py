# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels of the render, view layer and other tabs."""

import os

import bpy

from . import bake, engine, estimate, folders, hybrid, preferences, programs, properties

# Panels of Blender that are made for engines of its own kind and do not fit this one.
UNFIT = {"VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes", "RENDER_PT_simplify_viewport", "RENDER_PT_gpencil",
         "RENDER_PT_freestyle"}
# Panels of EEVEE that show the nodes of materials and worlds.
OF_NODES = {"EEVEE_MATERIAL_PT_context_material", "EEVEE_MATERIAL_PT_surface", "EEVEE_WORLD_PT_surface"}


class Panel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {engine.ID}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES

    def draw(self, context):
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        self.show(self.layout.column(), context, context.scene.shadowcache)


class SHADOWCACHE_PT_sampling(Panel, bpy.types.Panel):
    bl_label = "Sampling"

    def show(self, column, context, settings):
        row = column.row()
        row.active = not settings.target_error
        row.prop(settings, "camera_rays")
        for name in ("target_error", "samples", "bounces", "clamp_indirect", "viewport_rays", "seed",
                     *properties.OTHERS):
            column.prop(settings, name)
        for name in preferences.NEEDED:
            try:
                programs.find(name, preferences.program_folder())
            except programs.Missing as missing:
                column.label(text=str(missing), icon="ERROR")


class SHADOWCACHE_PT_bake(Panel, bpy.types.Panel):
    bl_label = "Cache"

    def show(self, column, context, settings):
        for name in ("bake_scope", "bake_quality", "bake_spacing", "stale", "use_motion", "cache_folder"):
            column.prop(settings, name)
        set_file = folders.set_file_of(context.scene, context.view_layer.name)
        recipe = bake.Recipe(settings)
        state = state_of(set_file, recipe)
        column.label(text=state, icon="INFO")
        expected = estimate.FOUND.get(estimate.key_of(set_file, recipe))
        if expected and not state.startswith("Baked"):
            for line in expected.split(". "):
                column.label(text=line, icon="TIME")
        row = column.row()
        row.operator("shadowcache.estimate")
        row.operator("shadowcache.forget")
        row.operator("shadowcache.free")


def state_of(set_file, recipe):
    """The cache in a line. Whether the set is still that of the cache is known when it is rendered."""
    notes = set_file.read_notes().get("bake")
    if not notes or not os.path.exists(set_file.cache):
        return "Missing: the next render bakes it"
    if notes["options"] != recipe.options():
        return "Stale: the settings of the bake have changed"
    if recipe.whole and not notes["whole"]:
        return "Of a shot: the next render bakes the rest"
    count = len(notes["views"])
    of = "the whole set" if notes["whole"] else "%d view%s" % (count, "s" * (count != 1))
    return "Baked: %s, %.1f MB" % (of, os.path.getsize(set_file.cache) / 1e6)


class SHADOWCACHE_PT_film(Panel, bpy.types.Panel):
    bl_label = "Film"

    def show(self, column, context, settings):
        column.prop(context.scene.render, "film_transparent")
        column.prop(settings, "filter")
        column.prop(settings, "filter_width")


class SHADOWCACHE_PT_hybrid(Panel, bpy.types.Panel):
    bl_label = "Hybrid"
    bl_options = {"DEFAULT_CLOSED"}

    def show(self, column, context, settings):
        rest = hybrid.scenes_of(context.scene)[hybrid.REST]
        if not rest:
            column.operator("shadowcache.hybrid")
            return
        for name in ("samples", "use_adaptive_sampling", "max_bounces"):
            column.prop(rest.cycles, name)
        if not hybrid.is_on(context.scene):
            column.label(text="Off: its nodes are not used", icon="INFO")
        row = column.row()
        row.operator("shadowcache.hybrid", text="Update")
        row.operator("shadowcache.hybrid_remove")


class SHADOWCACHE_PT_left_out(Panel, bpy.types.Panel):
    bl_label = "Not Rendered"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and bool(engine.LEFT_OUT.get(context.scene.name))

    def show(self, column, context, settings):
        for entry in engine.LEFT_OUT[context.scene.name]:
            column.label(text=entry)


class SHADOWCACHE_PT_passes(Panel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def show(self, column, context, settings):
        layer = context.view_layer
        for name in ("use_pass_z", "use_pass_position", "use_pass_normal"):
            column.prop(layer, name)
        column.prop(layer.shadowcache, "use_pass_variance")
        for kind in ("diffuse", "glossy"):
            row = column.row(heading=kind.title(), align=True)
            for part in ("direct", "indirect", "color"):
                row.prop(layer, "use_pass_%s_%s" % (kind, part), text=part.title(), toggle=True)
        column.prop(layer, "use_pass_emit", text="Emission")
        column.prop(layer, "use_pass_environment")
        if hasattr(layer, "cycles"):
            column.prop(layer.cycles, "denoising_store_passes")


CLASSES = (SHADOWCACHE_PT_sampling, SHADOWCACHE_PT_bake, SHADOWCACHE_PT_film, SHADOWCACHE_PT_hybrid,
           SHADOWCACHE_PT_left_out, SHADOWCACHE_PT_passes)


def shared_panels():
    """Panels of Blender that serve any engine."""
    for kind in bpy.types.Panel.__subclasses__():
        engines = getattr(kind, "COMPAT_ENGINES", None)
        if engines is None or kind in CLASSES:
            continue
        if ("BLENDER_RENDER" in engines and kind.__name__ not in UNFIT) or kind.__name__ in OF_NODES:
            yield kind


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    for kind in shared_panels():
        kind.COMPAT_ENGINES.add(engine.ID)


def unregister():
    for kind in shared_panels():
        kind.COMPAT_ENGINES.discard(engine.ID)
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
