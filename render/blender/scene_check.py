# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene, its view layer and its camera ask for that is not rendered; objects and materials are the export's."""

from .blender_export.cameras import differences_of
from .blender_export.differences import differences


def left_out(depsgraph, camera):
    """As texts. camera: an object, or None."""
    scene, layer = depsgraph.scene_eval, depsgraph.view_layer_eval
    found = ["scene %s: %s" % (scene.name, text) for text in differences(scene)]
    found += ["view layer %s: %s" % (layer.name, text) for text in differences(layer)]
    if camera and camera.type == "CAMERA":
        found += differences_of(camera)
    return found
