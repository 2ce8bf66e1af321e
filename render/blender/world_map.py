# SPDX-License-Identifier: GPL-3.0-or-later
"""A world of any nodes as a map: Cycles renders it, in a Blender of its own, so that this one's file stays as it is."""

import os
import shutil
import tempfile

import bpy

from . import child, fingerprint
from .world import require_no_object

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "world_bake.py")


class Baking:
    """The map of a world: made once for each state of the nodes. All but run() reads Blender's data."""

    def __init__(self, world, frame, folder):
        require_no_object(world)
        self.name = world.original.name
        self.frame = frame
        self.folder = folder
        self.work = None
        self.path = os.path.join(folder, "world-%s.exr" % fingerprint.digest_of(fingerprint.nodes_of(world.node_tree)))
        # The panorama's middle is at +x, as that of an Environment Texture without Mapping.
        self.fields = {"map": self.path, "rotate": 90}

    def __eq__(self, other):
        return isinstance(other, Baking) and self.fields == other.fields

    def is_made(self):
        return os.path.exists(self.path)

    def prepare(self, world):
        """Writes what run() needs, unless the map is there."""
        if self.is_made():
            return
        self.work = tempfile.TemporaryDirectory()
        bpy.data.libraries.write(os.path.join(self.work.name, "world.blend"), {world.original}, path_remap="ABSOLUTE",
                                 fake_user=True)

    def run(self, should_stop):
        """Makes the map, in any thread. Raises Failed, Cancelled."""
        if self.is_made():
            return
        os.makedirs(self.folder, exist_ok=True)
        part = os.path.join(self.work.name, "world.exr")
        command = [bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1", "-P", SCRIPT, "--",
                   os.path.join(self.work.name, "world.blend"), self.name, str(self.frame), part]
        try:
            child.run(command, should_stop)
        except child.Failed as error:
            raise child.Failed("world %s: Cycles made no map of it: %s" % (self.name, error)) from None
        shutil.copyfile(part, self.path + ".part")
        os.replace(self.path + ".part", self.path)


def of_world(world, frame, folder, should_stop):
    """Keys of the request environment."""
    baking = Baking(world, frame, folder)
    baking.prepare(world)
    baking.run(should_stop)
    return baking.fields
