"""What moves: the places of all instances, frame by frame."""

import zlib

import bpy
import numpy

from . import cameras
from .shown import world_matrices

# Constraints and modifiers that follow the frame without keys.
CONSTRAINTS = {"CAMERA_SOLVER", "FOLLOW_TRACK", "OBJECT_SOLVER", "TRANSFORM_CACHE"}
MODIFIERS = {"BUILD", "CLOTH", "COLLISION", "DYNAMIC_PAINT", "EXPLODE", "FLUID", "MESH_CACHE",
             "MESH_SEQUENCE_CACHE", "PARTICLE_SYSTEM", "SOFT_BODY", "WAVE"}


def has_keys(item):
    data = getattr(item, "animation_data", None)
    return bool(data and (data.action or data.drivers or data.nla_tracks))


def may_move(depsgraph, report, with_cameras=True):
    """Whether anything in the depsgraph depends on the frame; adds to the report what looks, but does not move."""
    found = bool(depsgraph.scene.rigidbody_world or bpy.app.handlers.frame_change_pre or
                 bpy.app.handlers.frame_change_post)
    for item in depsgraph.ids:
        if not with_cameras and (isinstance(item, bpy.types.Camera) or getattr(item, "type", "") == "CAMERA"):
            continue
        if isinstance(item, bpy.types.Material):
            if has_keys(item) or has_keys(item.node_tree):
                report.add("material %s: its animation" % item.name)
        elif isinstance(item, bpy.types.Light) and (has_keys(item) or has_keys(item.node_tree)):
            report.add("light %s: its animation" % item.name)
        elif has_keys(item):
            found = True
        elif isinstance(item, bpy.types.Object):
            found = found or any(c.type in CONSTRAINTS for c in item.constraints)
            found = found or any(m.type in MODIFIERS for m in item.modifiers)
        elif isinstance(item, bpy.types.GeometryNodeTree):
            found = found or any(n.bl_idname == "GeometryNodeInputSceneTime" for n in item.nodes)
    return found


def signature(depsgraph):
    """Equal if the instances of two frames are the same ones in the same order."""
    instances = depsgraph.object_instances
    numbers = numpy.empty(8 * len(instances), numpy.int32)
    instances.foreach_get("persistent_id", numbers)
    kinds = numpy.empty(len(instances), numpy.int32)
    instances.foreach_get("random_id", kinds)
    return [o.name_full for o in depsgraph.objects], numbers.tobytes(), kinds.tobytes()


def identities(depsgraph):
    """A name for each instance that is the same in all frames."""
    counts, names = {}, []
    for i in depsgraph.object_instances:
        name = (i.parent.name_full if i.is_instance else "", i.object.name_full, tuple(i.persistent_id))
        counts[name] = counts.get(name, 0) + 1
        names.append((name, counts[name]))
    return names


def shape_of(thing, depsgraph):
    """A number that changes with the vertices of an object."""
    mesh = thing.evaluated_get(depsgraph).data
    if not isinstance(mesh, bpy.types.Mesh):
        return 0
    places = numpy.empty(3 * len(mesh.vertices), numpy.float32)
    mesh.vertices.foreach_get("co", places)
    return zlib.crc32(places)


class Motion:
    """World matrices of the instances that are not at one place in all frames of the scene."""

    def __init__(self, depsgraph, set_frame, report, with_cameras=True):
        self.depsgraph = depsgraph
        self.report = report
        self.base = world_matrices(depsgraph)
        self.frames = []
        self._changes = []  # of each frame: rows, and their matrices
        if set_frame and may_move(depsgraph, report, with_cameras):
            self._record(set_frame)

    def _record(self, set_frame):
        scene = self.depsgraph.scene
        frame = scene.frame_current
        base_signature, base_identities = signature(self.depsgraph), identities(self.depsgraph)
        lenses = self._lenses()
        shapes = {o.original: None for o in self.depsgraph.ids if isinstance(o, bpy.types.Object) and may_deform(o)}
        shapes = {o: shape_of(o, self.depsgraph) for o in shapes}
        self.frames = list(range(scene.frame_start, scene.frame_end + 1))
        for f in self.frames:
            set_frame(f)
            places = world_matrices(self.depsgraph)
            if signature(self.depsgraph) != base_signature:
                places = self._matched(places, base_identities, frame)
            rows = numpy.flatnonzero((places != self.base).any(axis=(1, 2)))
            self._changes.append((rows, places[rows]))
            self._compare(shapes, lenses, frame)
        set_frame(frame)

    def _matched(self, places, base, frame):
        """The places of the base's instances; one that is not there has no size."""
        row_of = {name: row for row, name in enumerate(identities(self.depsgraph))}
        result = self.base.copy()
        result[:, :3, :3] = 0
        for row, name in enumerate(base):
            found = row_of.pop(name, None)
            if found is not None:
                result[row] = places[found]
        for (parent, name, _), _ in row_of:
            self.report.add("object %s: it is not there in frame %d, which is exported" % (parent or name, frame))
        return result

    def _lenses(self):
        scene = self.depsgraph.scene
        return {o.original: cameras.picture_size(o.data, scene)
                for o in self.depsgraph.objects if o.type == "CAMERA" and o.data.type != "PANO"}

    def _compare(self, shapes, lenses, frame):
        for camera, size in lenses.items():
            now = cameras.picture_size(camera.evaluated_get(self.depsgraph).data, self.depsgraph.scene)
            if not numpy.allclose(now, size, rtol=1e-5):
                self.report.add("camera %s: its lens changes" % camera.name)
        for thing, shape in shapes.items():
            if shape_of(thing, self.depsgraph) != shape:
                self.report.add("object %s: its vertices move; it is as in frame %d" % (thing.name, frame))

    def places(self, index):
        """World matrices of all instances in one of the frames."""
        result = self.base.copy()
        rows, places = self._changes[index]
        result[rows] = places
        return result

    def tracks(self):
        """Matrices (frames, 4, 4) by row, of those that move."""
        moving = sorted({int(row) for rows, _ in self._changes for row in rows})
        result = {row: numpy.repeat(self.base[row][None], len(self.frames), axis=0) for row in moving}
        for i, (rows, places) in enumerate(self._changes):
            for row, place in zip(rows, places):
                result[int(row)][i] = place
        return result


def may_deform(thing):
    return bool(thing.modifiers or getattr(thing.data, "shape_keys", None) or has_keys(thing.data))
