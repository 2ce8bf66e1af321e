"""Cameras, as glTF and as Shadowcache's camera files have them."""

import json
import math

import numpy

from . import matrices
from .differences import differences
from .report import Report

STAND_IN = "shadowcache stand-in"  # a camera that a render without one is started with; never exported


def picture_size(camera, scene):
    """Width and height of a camera's picture at distance 1, of an orthographic one anywhere: right whatever the
    sensor, its fit and the picture's sides are."""
    corners = camera.view_frame(scene=scene)
    distance = -corners[0].z if camera.type == "PERSP" else 1
    return tuple((max(c[k] for c in corners) - min(c[k] for c in corners)) / distance for k in (0, 1))


def differences_of(thing):
    """What of a camera, an object, is not rendered, as texts."""
    axes = numpy.array(thing.matrix_world, float)[:3, :3]
    found = list(differences(thing.data))
    if numpy.linalg.det(axes) < 0:
        found.append("it is mirrored, by a scale below 0")
    if matrices.has_shear(axes):
        found.append("its axes are sheared, by a parent's scale")
    return ["camera %s: %s" % (thing.data.name, text) for text in found]


def in_camera_files(camera, render):
    """What of a camera renders of a glTF document do not read."""
    if camera.shift_x or camera.shift_y:
        yield "shift"
    if camera.dof.use_dof:
        yield "depth of field"
    if render.pixel_aspect_x != render.pixel_aspect_y:
        yield "pixel aspect"


def entry(thing, scene, report):
    """A camera, an object, of a glTF document; None if it is a panorama."""
    camera = thing.data
    if camera.type not in ("PERSP", "ORTHO"):
        report.add("camera %s: %s" % (camera.name, camera.type.lower()))
        return None
    for text in differences_of(thing):
        report.add(text)
    for text in in_camera_files(camera, scene.render):
        report.add("camera %s: %s, which only CAMERA.json holds" % (camera.name, text))
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


def lens_of(thing):
    """Lens of an evaluated camera, as a camera file has it; None where all is sharp."""
    camera = thing.data
    dof = camera.dof
    if not dof.use_dof:
        return None
    focus = dof.focus_distance
    if dof.focus_object:
        matrix = thing.matrix_world
        focus = abs((dof.focus_object.matrix_world.translation - matrix.translation).dot(matrix.col[2].xyz.normalized()))
    focus = max(focus, 1e-5)
    focal_length = camera.lens * 1e-3 if camera.type == "PERSP" else 1
    radius = focal_length / (2 * dof.aperture_fstop)
    if camera.type == "ORTHO":
        # Cycles' lens is where the camera begins to see: the same rays through one at the camera.
        radius *= 1 + camera.clip_start / focus
        focus += camera.clip_start
    lens = {"radius": radius, "focus": focus}
    if dof.aperture_blades >= 3:
        # Blender's polygon has the middle of a side where that of a camera file has its first corner.
        lens["blades"] = min(dof.aperture_blades, 64)
        lens["rotation"] = dof.aperture_rotation + math.pi / dof.aperture_blades
    return lens


def frame_entry(thing, scene):
    """An evaluated camera in one frame of a camera file."""
    camera = thing.data
    pose = matrices.of_camera(numpy.array(thing.matrix_world, float))
    width, height = picture_size(camera, scene)
    corners = camera.view_frame(scene=scene)
    distance = -corners[0].z if camera.type == "PERSP" else 1
    middle = [(max(c[k] for c in corners) + min(c[k] for c in corners)) / (2 * distance) for k in (0, 1)]
    frame = {"origin": pose[:3, 3].tolist(), "forward": (-pose[:3, 2]).tolist(), "up": pose[:3, 1].tolist(),
             "shift": [middle[0] / width, middle[1] / height], "near": camera.clip_start, "far": camera.clip_end}
    if camera.type == "PERSP":
        frame["yfov"] = 2 * math.atan(height / 2)
    else:
        frame["height"] = height
    lens = lens_of(thing)
    if lens:
        frame["lens"] = lens
    return frame


def export_camera(depsgraph, path, set_frame, first=None):
    """Writes the scene's camera, frame by frame from frame `first` [the scene's first] on, which is frame 1 there.
    Returns what is left out."""
    scene, report, frames = depsgraph.scene, Report(), []
    if not scene.camera or scene.camera.name == STAND_IN or scene.camera.data.type not in ("PERSP", "ORTHO"):
        raise ValueError("%s: the scene has no perspective or orthographic camera" % path)
    for text in differences_of(scene.camera):
        report.add(text)
    for frame in range(scene.frame_start if first is None else first, scene.frame_end + 1):
        set_frame(frame)
        frames.append(frame_entry(scene.camera.evaluated_get(depsgraph), scene))
    render = scene.render
    with open(path, "w", encoding="ascii") as out:
        json.dump({"cam": {"fps": render.fps / render.fps_base, "frames": frames,
                           "pixel_aspect": render.pixel_aspect_x / render.pixel_aspect_y}}, out)
    return report.entries()
