# SPDX-License-Identifier: GPL-3.0-or-later
"""A world of any nodes as a map: Cycles renders it, in a Blender of its own, so that this one's file stays as it is."""

import os
import tempfile

import bpy

from . import child, fingerprint

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "world_bake.py")


def of_world(world, frame, folder, should_stop):
    """Keys of the request environment; the map is made once for each state of the nodes."""
    content = fingerprint.digest_of(fingerprint.nodes_of(world.node_tree))
    path = os.path.join(folder, "world-%s.exr" % content)
    if not os.path.exists(path):
        os.makedirs(folder, exist_ok=True)
        with tempfile.TemporaryDirectory() as work:
            blend = os.path.join(work, "world.blend")
            bpy.data.libraries.write(blend, {world.original}, path_remap="ABSOLUTE", fake_user=True)
            part = os.path.join(work, "world.exr")
            command = [bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1", "-P", SCRIPT,
                       "--", blend, world.original.name, str(frame), part]
            try:
                child.run(command, should_stop)
            except child.Failed as error:
                raise child.Failed("world %s: Cycles made no map of it: %s" % (world.name, error)) from None
            with open(part, "rb") as file, open(path + ".part", "wb") as out:
                out.write(file.read())
            os.replace(path + ".part", path)
    # The panorama's middle is at +x, as that of an Environment Texture without Mapping.
    return {"map": path, "rotate": 90}
