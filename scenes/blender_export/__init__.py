"""Exports what Blender (3.4) would render as Shadowcache reads it: .glb, .gltf or .ply.

For a render engine, which has the depsgraph of its render, and for the command line in export_from_blender.py.
"""

from . import cameras
from .cameras import export_camera
from .gltf_export import GltfExport
from .ply_export import export_ply
from .render_depsgraph import with_render_depsgraph
from .report import Report
from .shown import other_layers

__all__ = ["export", "export_camera", "with_render_depsgraph"]


def export(depsgraph, path, set_frame=None):
    """Writes the depsgraph's set to a .glb, .gltf or .ply; returns what of it the file cannot express, as texts.

    set_frame(frame) evaluates the depsgraph in a frame of the scene, as RenderEngine.frame_set does; without it
    nothing moves in the file. A depsgraph of a viewport gives what the viewport shows.
    Raises ValueError if nothing would be rendered, or path ends otherwise; OSError if it cannot be written."""
    report = Report()
    for name in other_layers(depsgraph):
        report.add("view layer %s: only %s is exported" % (name, depsgraph.view_layer.name))
    if path.endswith(".ply"):
        export_ply(depsgraph, path, report)
    elif path.endswith((".glb", ".gltf")):
        for marker in cameras.changes(depsgraph.scene):
            report.add("marker %s: it changes the scene's camera to %s" % (marker.name, marker.camera.name))
        GltfExport(depsgraph, report).write(path, set_frame)
    else:
        raise ValueError("%s: expected .glb, .gltf or .ply" % path)
    return report.entries()
