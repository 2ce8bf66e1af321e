# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of a scene and of a view layer."""

import bpy

from .option_table import ROWS, property_of


def option(name, /, **own):
    """The property of an option of the renderer; what is said here differs from its row in the table."""
    return property_of(name, bpy, **own)


class ShadowcacheSettings(bpy.types.PropertyGroup):
    cache_folder: bpy.props.StringProperty(
        name="Folder", subtype="DIR_PATH", default="//shadowcache",
        description="Where sets, caches and maps are kept; beside an unsaved file: Blender's temporary folder")
    bake_scope: bpy.props.EnumProperty(
        name="Bake", default="SHOT", items=(
            ("SHOT", "This Shot", "What the pictures look up, of the frame or the animation that is rendered"),
            ("SET", "Whole Set", "Every surface: takes longer, once for all cameras")))
    bake_quality: bpy.props.EnumProperty(
        name="Quality", default="GOOD", items=(
            ("DRAFT", "Draft", "An eighth of the rays: pictures are free of bias as well, with a little more noise"),
            ("GOOD", "Good", "The least time for bake and pictures together: as fine as number and size of the frames are worth"),
            ("FINE", "Fine", "Eight times the rays, for a cache that more frames will use than are rendered now")))
    bake_spacing: bpy.props.FloatProperty(
        name="Spacing", subtype="DISTANCE", min=0, soft_max=10, default=0,
        description="Side of a voxel: smaller ones take longer to bake, and pictures are less noisy. 0: chosen from the size of the set, the frames and the quality")
    stale: bpy.props.EnumProperty(
        name="Stale Cache", default="BAKE", items=(
            ("BAKE", "Bake Again", "Where the set is not what was baked"),
            ("USE", "Use", "Free of bias all the same, but noisier where the set has changed")))
    use_motion: bpy.props.BoolProperty(
        name="Moving Objects", default=True,
        description="Objects that move in the scene's frames are rendered in each frame and not baked. Off: each frame is a set of its own, baked as a whole")
    camera_rays: option("camera_rays", default=16, description="Camera rays of a pixel: edges, depth of field")
    target_error: option(
        "target_error", name="Noise Target", min=0, max=1, precision=4, step=0.1,
        description="Error of the picture, the mean of variance over squared luminance: each part gets the camera rays that it needs, found by a pilot. 0: as many as Camera Rays says")
    samples: option("samples", name="Shadow Rays", min=1, default=4, description="Shadow rays of each camera ray")
    bounces: option("bounces", soft_max=64, default=4, description="Surfaces that light may meet before the one that is seen")
    clamp_indirect: option(
        "clamp_indirect", description="Most radiance that bounces add to a camera ray: no fireflies, but darker. 0: off, free of bias")
    seed: option("seed", description="Of all random numbers; each frame has its own in any case")
    filter: option("filter", name="Pixel Filter", items=(
        ("blackman-harris", "Blackman-Harris", "As in Cycles"), ("gaussian", "Gaussian", ""), ("box", "Box", "")))
    filter_width: option(
        "filter_width", name="Width", subtype="PIXEL", min=0.01, max=10, default=1.5, description="Of the pixel filter")
    viewport_rays: bpy.props.IntProperty(
        name="Viewport Rays", min=1, max=4096, default=64, description="Rays of a pixel until the viewport rests")
    # Made and removed by the operators of the hybrid.
    hybrid_rest: bpy.props.PointerProperty(type=bpy.types.Scene)
    hybrid_lamps: bpy.props.PointerProperty(type=bpy.types.Scene)


# Options that are not laid out above.
OTHERS = [name for name in ROWS if name not in ShadowcacheSettings.__annotations__]
for name in OTHERS:
    ShadowcacheSettings.__annotations__[name] = option(name)


class ShadowcacheLayerSettings(bpy.types.PropertyGroup):
    use_pass_variance: bpy.props.BoolProperty(
        name="Noise Variance", description="Variance of the luminance that is left in each pixel")


CLASSES = (ShadowcacheSettings, ShadowcacheLayerSettings)


def register():
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Scene.shadowcache = bpy.props.PointerProperty(type=ShadowcacheSettings)
    bpy.types.ViewLayer.shadowcache = bpy.props.PointerProperty(type=ShadowcacheLayerSettings)


def unregister():
    del bpy.types.ViewLayer.shadowcache
    del bpy.types.Scene.shadowcache
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
