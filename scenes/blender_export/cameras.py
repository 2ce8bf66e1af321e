"""Cameras, as glTF and as Shadowcache's camera files have them."""

import json
import math

import numpy

from . import matrices
from .report import Report

STAND_IN = "shadowcache stand-in"  # a camera that a render without one is started with; never exported


def picture_size(camera, scene):
    """Width and height of a camera's picture at distance 1, of an orthographic one anywhere: right whatever the
    sensor, its fit and the picture's sides are."""
    corners = camera.view_frame(scene=scene)
    distance = -corners[0].z if camera.type == "PERSP" else 1
    return tuple((max(c[k] for c in corners) - min(c[k] for c in corners)) / distance for k in (0, 1))


def entry(camera, scene, report):
    """A camera of a glTF document; None if it is a panorama."""
    if camera.type not in ("PERSP", "ORTHO"):
        report.add("camera %s: %s" % (camera.name, camera.type.lower()))
        return None
    if camera.shift_x or camera.shift_y:
        report.add("camera %s: shift" % camera.name)
    if camera.dof.use_dof:
        report.add("camera %s: depth of field" % camera.name)
    width, height = picture_size(camera, scene)
    if camera.type == "ORTHO":
        return {"name": camera.name, "type": "orthographic", "orthographic": {
            "xmag": width / 2, "ymag": height / 2, "znear": camera.clip_start, "zfar": camera.clip_end}}
    return {"name": camera.name, "type": "perspective", "perspective": {
        "yfov": 2 * math.atan(height / 2), "aspectRatio": width / height, "znear": camera.clip_start,
        "zfar": camera.clip_end}}


def changes(scene):
    """Markers that change the scene's camera."""
    return [m for m in scene.timeline_markers if m.camera and m.camera != scene.camera]


def export_camera(depsgraph, path, set_frame):
    """Writes the scene's camera, frame by frame; the scene's first frame is frame 1 there. Returns what is left out.

    The angle of view is that of the picture's height."""
    scene, report, frames = depsgraph.scene, Report(), []
    if not scene.camera or scene.camera.name == STAND_IN or scene.camera.data.type != "PERSP":
        raise ValueError("%s: the scene has no perspective camera" % path)
    entry(scene.camera.data, scene, report)
    size = picture_size(scene.camera.evaluated_get(depsgraph).data, scene)
    for frame in range(scene.frame_start, scene.frame_end + 1):
        set_frame(frame)
        camera = scene.camera.evaluated_get(depsgraph)
        pose = matrices.of_camera(numpy.array(camera.matrix_world, float))
        frames.append({"origin": pose[:3, 3].tolist(), "forward": (-pose[:3, 2]).tolist(), "up": pose[:3, 1].tolist()})
        if not numpy.allclose(picture_size(camera.data, scene), size, rtol=1e-5):
            report.add("camera %s: its lens changes" % camera.name)
    with open(path, "w", encoding="ascii") as out:
        json.dump({"cam": {"yfov": 2 * math.atan(size[1] / 2), "fps": scene.render.fps / scene.render.fps_base,
                           "frames": frames}}, out)
    return report.entries()
