# SPDX-License-Identifier: GPL-3.0-or-later
"""The set of a view layer as a file: exported where it is not what the file holds."""

import json
import os

from . import fingerprint
from .blender_export.gltf_export import GltfExport
from .blender_export.report import Report

FORMAT = 4
MOST_GAIN = 1e6  # of the request lamps
# Entries of the export on other frames: each frame is exported with what it shows.
OF_OTHER_FRAMES = (": its animation", ": its vertices move; it is as in frame", ": it is not there in frame")


class SetFile:
    """SET.glb in a folder, and what it holds in SET.json beside it."""

    def __init__(self, folder, name):
        self.path = os.path.join(folder, name + ".glb")
        self.cache = os.path.join(folder, name + ".vdb")
        self.notes = os.path.join(folder, name + ".json")

    def read_notes(self):
        try:
            with open(self.notes, encoding="utf-8") as file:
                found = json.load(file)
        except (OSError, ValueError):
            return {}
        return found if isinstance(found, dict) and found.get("format") == FORMAT else {}

    def write_notes(self, notes):
        part = self.notes + ".part"
        with open(part, "w", encoding="utf-8") as out:
            json.dump({**notes, "format": FORMAT}, out)
        os.replace(part, self.notes)

    def holds(self, state, scene, motion=True):
        """Whether the file holds a state of the set in the scene's frame. motion: a file in which things move will
        do."""
        notes = self.read_notes()
        if not os.path.exists(self.path) or notes.get("content") != state.content or self.gains(state) is None:
            return False
        held = notes["places"]
        if "" in held:
            return held[""] == state.places
        return bool(motion) and notes["fps"] == fps(scene) and held.get(str(scene.frame_current)) == state.places

    def gains(self, state):
        """Keys of the request lamps that make the file's lamps as strong as a state's; None: there are none."""
        found, strengths = [], self.read_notes().get("strengths", {})
        for name, now in state.strengths.items():
            held = strengths.get(name)
            if held is None or any(a > MOST_GAIN * b for a, b in zip(now, held)):
                return None
            if now != held:
                found.append("%s=%r,%r,%r" % (name, *(a / b if b else 1.0 for a, b in zip(now, held))))
        return found

    def all_moves(self):
        """Whether nothing of the set stands still, or there is nothing, so that nothing is to be baked."""
        return bool(self.read_notes().get("all_moves"))

    def load_fields(self, scene, cache, lamps=True):
        """Keys of the request load. cache: None: without one. lamps: what emits lights the set."""
        fields = {"set": [self.path], "stale-ok": True, "fps": fps(scene), "lamps": "on" if lamps else "off"}
        if self.all_moves():
            fields["set-frame"] = scene.frame_current
        return {**fields, "cache": cache} if cache else fields

    def left_out(self, state):
        """What the file cannot express, and what it does not hold of a state."""
        found = dict.fromkeys(state.left_out + self.read_notes().get("left_out", []))
        return [entry for entry in found if not any(words in entry for words in OF_OTHER_FRAMES)]

    def update(self, depsgraph, set_frame, motion=True, panes=True):
        """Exports the set unless the file holds it as it is in the current frame. set_frame(frame) as of
        blender_export.export; None: the export is of this frame alone. motion: whether a file in which things move
        will do. panes: whether light is to pass glass. Returns the state."""
        state = fingerprint.State(depsgraph, panes)
        if not self.holds(state, depsgraph.scene, motion):
            self.export(depsgraph, state, set_frame if motion else None)
        return state

    def export(self, depsgraph, state, set_frame=None):
        """Writes the set, whose state in the current frame is known."""
        os.makedirs(os.path.dirname(self.path), exist_ok=True)
        notes = self.read_notes()
        report = Report()
        rows = fingerprint.mesh_rows(depsgraph)
        export = GltfExport(depsgraph, report, with_cameras=False, panes=state.panes, stand_in=True)
        found = export.write(self.path + ".part.glb", set_frame)
        os.replace(self.path + ".part.glb", self.path)
        held = {"": state.places}
        moving = set(found.tracks())
        if moving:
            held = {str(f): fingerprint.places_digest(found.places(i), rows) for i, f in enumerate(found.frames)}
        notes.update(content=state.content, strengths=state.strengths, places=held, id=fingerprint.digest_of(state.content, sorted(held.items())),
                     fps=fps(depsgraph.scene), all_moves=moving.issuperset(rows),
                     left_out=[entry for entry in report.entries() if entry not in state.left_out])
        self.write_notes(notes)


def fps(scene):
    return scene.render.fps / scene.render.fps_base
