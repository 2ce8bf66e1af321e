# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera and the picture's sides, as requests have them."""

import numpy

from .blender_export.cameras import frame_entry
from .child import Failed


def size_of(scene):
    render = scene.render
    return (max(1, render.resolution_x * render.resolution_percentage // 100),
            max(1, render.resolution_y * render.resolution_percentage // 100))


def region_of(scene):
    """Of a render's border, x and y from the upper left pixel; the whole frame without one."""
    render = scene.render
    width, height = size_of(scene)
    if not render.use_border:
        return {"x": 0, "y": 0, "width": width, "height": height}
    # Blender cuts off what is behind the point, in single precision; rows count from the bottom there.
    left, right = (int(numpy.float32(x) * numpy.float32(width)) for x in (render.border_min_x, render.border_max_x))
    low, high = (int(numpy.float32(y) * numpy.float32(height)) for y in (render.border_min_y, render.border_max_y))
    return {"x": left, "y": height - high, "width": right - left, "height": high - low}


def camera_at(scene, frame):
    """The scene's camera in a frame: the markers' where they have some."""
    markers = sorted((m for m in scene.timeline_markers if m.camera), key=lambda m: m.frame)
    if not markers:
        return scene.camera
    before = [m for m in markers if m.frame <= frame]
    return (before or markers)[-1 if before else 0].camera


def view_of(thing, scene):
    """Keys of the request camera, of an evaluated camera."""
    if thing is None:
        raise Failed("scene %s: no camera" % scene.name)
    if thing.type != "CAMERA" or thing.data.type not in ("PERSP", "ORTHO"):
        raise Failed("camera %s: %s, expected perspective or orthographic"
                     % (thing.name, getattr(thing.data, "type", thing.type).lower()))
    render = scene.render
    return {**frame_entry(thing, scene), "pixel_aspect": render.pixel_aspect_x / render.pixel_aspect_y}
