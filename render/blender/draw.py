# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws linear pixels into a 3D view. Blender applies the scene's view transform afterwards."""

import gpu
import numpy
from gpu_extras.presets import draw_texture_2d

MOST = 65504  # that the half floats of a view can hold


def rows_of(planes):
    """Planes (4, height, width) from the top, as textures have them: rows from the bottom, (height, width, 4)."""
    return numpy.ascontiguousarray(numpy.minimum(planes[:, ::-1], MOST).transpose(1, 2, 0), numpy.float32)


def texture_of(rows):
    height, width, _ = rows.shape
    return gpu.types.GPUTexture((width, height), format="RGBA16F",
                                data=gpu.types.Buffer("FLOAT", rows.size, rows.reshape(-1)))


def draw(engine, scene, texture, width, height):
    """Over a whole region."""
    gpu.state.blend_set("ALPHA_PREMULT")
    engine.bind_display_space_shader(scene)
    draw_texture_2d(texture, (0, 0), width, height)
    engine.unbind_display_space_shader()
    gpu.state.blend_set("NONE")
