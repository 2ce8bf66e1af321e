# SPDX-License-Identifier: GPL-3.0-or-later
"""What a 3D view looks at, as the request camera has it: exact, by the view's own matrices."""

import math

import numpy

from .blender_export import matrices
from .blender_export.cameras import lens_of


def view_of_matrices(view_matrix, window_matrix):
    """Keys of the request, but for pixel_aspect, and the view's width over its height.

    view_matrix: world to view; window_matrix: view to clip space. An orthographic view begins at its near plane, which
    may be behind its origin.
    """
    view, window = numpy.array(view_matrix, float), numpy.array(window_matrix, float)
    pose = matrices.of_camera(numpy.linalg.inv(view))
    forward, origin = -pose[:3, 2], pose[:3, 3]
    keys = {"forward": forward.tolist(), "up": pose[:3, 1].tolist()}
    if window[3, 3] == 0:
        # x / -z of the picture's middle is window[0, 2] / window[0, 0]; its whole width is 2 / window[0, 0].
        keys["yfov"] = 2 * math.atan(1 / window[1, 1])
        keys["shift"] = [window[0, 2] / 2, window[1, 2] / 2]
        keys["near"] = window[2, 3] / (window[2, 2] - 1)
    else:
        keys["height"] = 2 / window[1, 1]
        keys["shift"] = [-window[0, 3] / 2, -window[1, 3] / 2]
        origin = origin + forward * (window[2, 3] + 1) / window[2, 2]
    keys["origin"] = origin.tolist()
    return keys, window[1, 1] / window[0, 0]


def view_of(region_data, camera, depsgraph):
    """As above, of a 3D view; with the lens of the camera through which it looks."""
    keys, aspect = view_of_matrices(region_data.view_matrix, region_data.window_matrix)
    if region_data.view_perspective == "CAMERA" and camera and camera.type == "CAMERA":
        lens = lens_of(camera.evaluated_get(depsgraph))
        if lens:
            keys["lens"] = lens
    return keys, aspect


def with_size(view, aspect, width, height):
    """The request camera for a picture of so many pixels."""
    return {**view, "pixel_aspect": aspect * height / width}
