# SPDX-License-Identifier: GPL-3.0-or-later
"""A world of any nodes as a map: Cycles renders it, in a Blender of its own, so that this one's file stays as it is."""

import json
import os
import shutil
import tempfile

import bpy
import numpy

from . import child, fingerprint, world
from .blender_export.texels import has_texels, pixels_of
from .world import nodes_in, require_no_object

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "world_bake.py")
FORMAT = 2  # rises where the same nodes make another map


def trees_of(tree):
    """A tree and the groups in it, with their names; its own is ""."""
    groups = {node.node_tree.name: node.node_tree for node in nodes_in(tree) if getattr(node, "node_tree", None)}
    return {"": tree, **groups}.items()


def held_values(tree):
    """Of an evaluated world's nodes, what animation and drivers make of them: [name of the group, or "", path, value].
    They may depend on the scene, without which the map is made."""
    found = []
    for name, group in trees_of(tree):
        for path in animated_paths(group.original.animation_data):
            try:
                value = group.path_resolve(path)
            except ValueError:  # of a node that was removed
                continue
            found.append((name, path, list(value) if hasattr(value, "__len__") and not isinstance(value, str) else value))
    return found


def animated_paths(animation):
    if not animation:
        return []
    actions = [animation.action] + [strip.action for track in animation.nla_tracks for strip in track.strips]
    curves = [curve for action in actions if action for curve in action.fcurves]
    return sorted({curve.data_path for curve in (*animation.drivers, *curves)})


def is_lost(image):
    """Whether a file that Blender writes lacks the texels of an image that Cycles has from Blender: those that were made in it,
    and what was painted on packed ones. Of others Cycles reads the files."""
    return has_texels(image) and (image.source == "GENERATED" or bool(image.packed_file) and image.is_dirty)


def write_images(tree, folder):
    """Writes the texels of images that are lost; their places [name of the group, or "", node, file, settings]."""
    found, files = [], {}
    for name, group in trees_of(tree):
        for node in group.nodes:
            image = getattr(node, "image", None)
            if image is None or not is_lost(image):
                continue
            if image.name_full not in files:
                files[image.name_full] = "image%d.npy" % len(files)
                numpy.save(os.path.join(folder, files[image.name_full]), pixels_of(image)[::-1])
            settings = {"is_float": image.is_float, "space": image.colorspace_settings.name, "alpha_mode": image.alpha_mode}
            found.append((name, node.name, files[image.name_full], settings))
    return found


class Baking:
    """The map of a world: made once for each state of the nodes. All but run() reads Blender's data."""

    def __init__(self, of, frame, folder):
        require_no_object(of)
        self.name = of.original.name
        self.frame = frame
        self.folder = folder
        self.work = None
        self.path = os.path.join(folder, "world-%s.exr" % fingerprint.digest_of(FORMAT, fingerprint.nodes_of(of.node_tree)))
        # The panorama's middle is at +x, as that of an Environment Texture without Mapping.
        self.fields = {"map": self.path, "rotate": 90}

    def __eq__(self, other):
        return isinstance(other, Baking) and self.fields == other.fields

    def is_made(self):
        return os.path.exists(self.path)

    def prepare(self, of):
        """Writes what run() needs, unless the map is there."""
        if self.is_made():
            return
        self.work = tempfile.TemporaryDirectory()
        bpy.data.libraries.write(os.path.join(self.work.name, "world.blend"), {of.original}, path_remap="ABSOLUTE",
                                 fake_user=True)
        with open(os.path.join(self.work.name, "held.json"), "w", encoding="utf-8") as out:
            json.dump({"values": held_values(of.node_tree), "images": write_images(of.node_tree, self.work.name)}, out)

    def run(self, should_stop):
        """Makes the map, in any thread. Raises Failed, Cancelled."""
        if self.is_made():
            return
        os.makedirs(self.folder, exist_ok=True)
        part = os.path.join(self.work.name, "world.exr")
        command = [bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1", "-P", SCRIPT, "--",
                   os.path.join(self.work.name, "world.blend"), os.path.join(self.work.name, "held.json"), self.name,
                   str(self.frame), part]
        try:
            child.run(command, should_stop)
        except child.Failed as error:
            raise child.Failed("world %s: Cycles made no map of it: %s" % (self.name, error)) from None
        shutil.copyfile(part, self.path + ".part")
        os.replace(self.path + ".part", self.path)


def light_of(scene, layer, folder):
    """Keys of the request environment, or the Baking that makes them; and what of the world is left out."""
    if not layer.use_sky:
        return world.DARK, []  # as in Cycles
    try:
        return world.plain(scene.world, folder), world.left_out(scene.world, True)
    except world.NotPlain:
        pass
    # Not in the handler: Blender's libraries.write leaks an exception, whose context would keep the engine.
    return Baking(scene.world, scene.frame_current, folder), world.left_out(scene.world, False)


def keys_of(light, should_stop, say):
    """Keys of the request environment, of what light_of() has found; a Baking is prepared. In any thread."""
    if not isinstance(light, Baking):
        return light
    if not light.is_made():
        say("World: Cycles makes a map of its nodes")
    light.run(should_stop)
    return light.fields
