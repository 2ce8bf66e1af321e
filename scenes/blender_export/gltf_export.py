"""A glTF document of a render depsgraph."""

from collections import Counter

import numpy

from . import cameras, lamps, matrices
from .gltf_file import GltfFile
from .materials import Materials
from .meshes import MeshWriter
from .motion import Motion
from .pictures import Pictures
from .shown import materials_of, walk

# Of a set with so many polygons that rays pass that light may meet more of them on its way there and back to the camera.
MOST_PASSED = "Transparent Max Bounces: Cycles ends light behind %d transparent surfaces, here it goes on"


def passed_by_cycles(scene):
    """How many transparent surfaces a ray passes in Cycles; None without that add-on."""
    return getattr(getattr(scene, "cycles", None), "transparent_max_bounces", None)


class GltfExport:
    """Meshes, cameras, lamps and their places; animations of those that move, sampled in each frame of the scene."""

    def __init__(self, depsgraph, report, with_cameras=True, panes=True, stand_in=False):
        """stand_in: where nothing that stands still has a face, the file has a triangle too small to be seen, so that it is a
        set in each frame."""
        self.depsgraph = depsgraph
        self.report = report
        self.with_cameras = with_cameras
        self.stand_in = stand_in
        self.file = GltfFile()
        self.materials = Materials(self.file, Pictures(self.file, report), report, panes)
        self.meshes = MeshWriter(self.file, self.materials, report)
        self.by_data = {}
        self.channels, self.samplers = [], []

    def write(self, path, set_frame):
        """Writes the file; returns the motion in it."""
        entries = self._entries()
        motion = Motion(self.depsgraph, set_frame, self.report, self.with_cameras)
        tracks = motion.tracks()
        # What stands still with a scale of 0 is not there.
        entries = [(row, node) for row, node in entries if row in tracks or motion.base[row][:3, :3].any()]
        meshes = [row for row, node in entries if "mesh" in node]
        if self.stand_in and all(row in tracks for row in meshes):
            self._add_stand_in([matrices.of_mesh(motion.base[row])[:3, 3] for row in meshes[:1]])
        times = None
        if tracks:
            render = self.depsgraph.scene.render
            seconds = numpy.array(motion.frames, float) * render.fps_base / render.fps
            times = self.file.add_accessor(seconds.astype(numpy.float32), bounds=True)
        for row, node in entries:
            of = matrices.of_mesh if "mesh" in node else matrices.of_camera if "camera" in node else matrices.of_lamp
            if row in tracks:
                self._add_moving(node, of(tracks[row]), times)
            else:
                self.file.add("nodes", {**node, "matrix": of(motion.base[row]).T.reshape(-1).tolist()})
        if self.channels:
            self.file.add("animations", {"name": "scene", "channels": self.channels, "samplers": self.samplers})
        self.file.write(path)
        return motion

    def _entries(self):
        """Row and node of all that is shown."""
        known, entries, scene, seen, through_glass, passed = {}, [], self.depsgraph.scene, set(), [], Counter()
        for shown in walk(self.depsgraph, self.report):
            if shown.kind == "CAMERA":
                if not self.with_cameras:
                    continue
                seen.add(shown.name)
                camera = cameras.entry(shown.thing, scene, self.report)
                if camera:
                    entries.append((shown.row, {"name": shown.name, "camera": self.file.add("cameras", camera)}))
                continue
            if shown.kind == "LIGHT":
                lamps.name_differences(shown.thing, self.report)
                light = lamps.entry(shown.thing, self.report)
                if light:
                    entries.append((shown.row, {"name": shown.name, "extensions": self._light(light)}))
                    if lamps.is_seen_through_glass(shown.thing):
                        through_glass.append(shown.name)
                continue
            if shown.key not in known:
                known[shown.key] = self._mesh_of(shown.thing)
            if known[shown.key] is not None:
                passed.update(self.meshes.passed[known[shown.key]])
                entries.append((shown.row, {"name": shown.name, "mesh": known[shown.key]}))
        for name in through_glass if self.materials.has_glass else ():
            self.report.share(lamps.THROUGH_GLASS, name)
        most = passed_by_cycles(scene)
        for name in sorted(passed) if most is not None and 2 * passed.total() > most else ():
            self.report.share(MOST_PASSED % most, name)
        if self.with_cameras and scene.camera and scene.camera.name not in seen | {cameras.STAND_IN}:
            self.report.add("camera %s: renders hide it" % scene.camera.name)
        return entries

    def _add_stand_in(self, places):
        """A hundredth of a millimetre at the first of the places, which a set far from it would be rounded by; else a
        thousand kilometres down."""
        corners = numpy.array([(0, 0, 0), (1e-5, 0, 0), (0, 0, 1e-5)], numpy.float32)
        place = [float(number) for number in places[0]] if places else [0.0, -1e6, 0.0]
        primitive = {"attributes": {"POSITION": self.file.add_accessor(corners, bounds=True)},
                     "indices": self.file.add_accessor(numpy.arange(3, dtype=numpy.uint32))}
        mesh = self.file.add("meshes", {"name": "nothing", "primitives": [primitive]})
        self.file.add("nodes", {"name": "nothing", "mesh": mesh, "translation": place})

    def _light(self, light):
        """A node's extensions with a light."""
        self.file.use(lamps.EXTENSION)
        lights = self.file.document.setdefault("extensions", {}).setdefault(lamps.EXTENSION, {"lights": []})["lights"]
        lights.append(light)
        return {lamps.EXTENSION: {"light": len(lights) - 1}}

    def _mesh_of(self, thing):
        """Objects share evaluated meshes where they have no modifiers, and may have materials of their own."""
        materials = materials_of(thing, self.depsgraph)
        key = (thing.data.as_pointer(), *(m.name_full if m else None for m in materials))
        if key not in self.by_data:
            self.by_data[key] = self.meshes.write(thing.data.name, thing.data, materials)
        return self.by_data[key]

    def _add_moving(self, node, track, times):
        if any(matrices.has_shear(m) for m in track):
            pairs = [matrices.sheared_parts(m) for m in track]
            inner = self.file.add("nodes", {**node, "rotation": pairs[0][1]})
            self._add_channel(inner, "rotation", [rotation for _, rotation in pairs], times)
            node, parts = {"name": node["name"], "children": [inner]}, [outer for outer, _ in pairs]
        else:
            parts = [matrices.parts(m) for m in track]
        keys = dict(zip(("translation", "rotation", "scale"), zip(*parts)))
        number = self.file.add("nodes", {**node, **{path: values[0] for path, values in keys.items()}})
        for path, values in keys.items():
            self._add_channel(number, path, values, times)

    def _add_channel(self, node, path, values, times):
        output = self.file.add_accessor(numpy.array(values, numpy.float32))
        self.channels.append({"sampler": len(self.samplers), "target": {"node": node, "path": path}})
        self.samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})
