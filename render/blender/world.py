# SPDX-License-Identifier: GPL-3.0-or-later
"""The world of a scene as the request environment has it: a map, how it is turned, and its gain.

An Environment Texture with a Mapping that turns or mirrors, times constants, is passed on as it is. Everything else is
baked to a map by Cycles (world_map).
"""

import os

import numpy
from mathutils import Euler

from . import exr, fingerprint
from .blender_export.differences import differences, node_differences
from .blender_export.image_files import path_of
from .blender_export.node_values import Reader, constant, link_of, output_of, source
from .blender_export.texels import (DATA, LINEAR, MOST_APART, filter_gap, has_texels, is_encoded, linear_texels,
                                    stored_texels, unknown_of)
from .map_file import is_read_alike

AXES = numpy.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)    # of Blender to those of glTF
MIDDLE = numpy.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], float)  # the image's, to +X
# What a map cannot know: a world that differs by who looks.
BY_VIEW = {"LIGHT_PATH", "CAMERA"}
BY_VIEW_SOCKETS = {"Window", "Camera", "Reflection"}
DARK = {"radiance": [0, 0, 0]}


class NotPlain(Exception):
    """The nodes are not those of a map that is turned and multiplied."""


def background_of(world, reader):
    """The Background node that is the whole world; None for nothing at all."""
    output = output_of(world.node_tree)
    if not output:
        return None
    if source(output.inputs["Volume"]):
        raise NotPlain
    found = source(output.inputs["Surface"])
    if found is None:
        return None
    if found.node.type != "BACKGROUND":
        raise NotPlain
    return reader.see(found.node)


def own(socket):
    """The value of a socket that nothing feeds."""
    if link_of(socket):
        raise NotPlain
    return constant(socket)


def turn_of(node, reader):
    """3x3: directions of the map to those of Blender's world, for an Environment Texture."""
    socket, mapping = node.inputs["Vector"], None
    feeding = source(socket)
    if feeding and feeding.node.type == "MAPPING":
        mapping = reader.see(feeding.node)
        feeding = source(mapping.inputs["Vector"])
        if feeding is None:
            raise NotPlain
    if feeding is None and link_of(socket) or feeding and (feeding.node.type != "TEX_COORD" or feeding.name != "Generated"):
        raise NotPlain
    if mapping is None:
        return numpy.eye(3)
    kind = mapping.vector_type
    if kind in ("POINT", "TEXTURE") and any(own(mapping.inputs["Location"])):
        raise NotPlain
    scale = numpy.array(own(mapping.inputs["Scale"]), float)
    if not scale.all() or not numpy.allclose(abs(scale), abs(scale[0]), rtol=1e-5):
        raise NotPlain
    mirror = numpy.diag(numpy.sign(scale))
    rotation = numpy.array(Euler(own(mapping.inputs["Rotation"])).to_matrix(), float)
    # The node makes the map's direction of the world's: rotation times mirror, or for a texture the inverse of that.
    return rotation @ mirror if kind == "TEXTURE" else mirror @ rotation.T


def nodes_in(tree):
    """Those of groups, too."""
    for node in tree.nodes:
        yield node
        if getattr(node, "node_tree", None):
            yield from nodes_in(node.node_tree)


def require_no_object(world):
    """Cycles makes the map without the scene's objects."""
    for node in nodes_in(world.node_tree):
        if node.type == "TEX_COORD" and node.object and node.outputs["Object"].is_linked:
            raise ValueError("world %s: node %s follows the object %s, expected Generated and a Mapping"
                             % (world.name, node.name, node.object.name))


def by_view(tree):
    """Names of nodes whose value depends on who looks."""
    found = []
    for node in nodes_in(tree):
        if node.type in BY_VIEW and any(s.is_linked for s in node.outputs):
            found.append(node.bl_label)
        if node.type == "TEX_COORD":
            found += ["%s %s" % (node.bl_label, s.name) for s in node.outputs
                      if s.is_linked and s.name in BY_VIEW_SOCKETS]
    return found


def of_layer(tree):
    """Names of attributes of the view layer and the scene, without which Cycles makes the map."""
    return [node.attribute_name for node in nodes_in(tree) if node.type == "ATTRIBUTE" and
            node.attribute_type == "VIEW_LAYER" and any(s.is_linked for s in node.outputs)]


def left_out(world, is_plain):
    """What the map of a world does not show."""
    if world is None:
        return []
    found = list(differences(world))
    if world.use_nodes:
        output = output_of(world.node_tree)
        if output and source(output.inputs["Volume"]):
            found.append("Volume")
        if not is_plain:
            found += ["node %s: all see it as the camera does" % name for name in by_view(world.node_tree)]
            found += ["attribute %s of the view layer: the map is made without it" % name for name in of_layer(world.node_tree)]
    return ["world %s: %s" % (world.name, text) for text in found]


def file_of(image, folder):
    """An EXR or HDR file of an image's linear texels: its own, or one that is written."""
    if image.source not in ("FILE", "GENERATED") or unknown_of(image) or any(differences(image)):
        raise NotPlain
    path = path_of(image)
    if path and not os.path.isfile(path):
        raise FileNotFoundError("image %s: no file %s" % (image.name, path))
    if path and image.is_dirty:
        raise NotPlain  # Cycles shows the file, without what was painted
    if path.lower().endswith((".exr", ".hdr")):
        if not is_read_alike(image, path):
            raise NotPlain
        if image.colorspace_settings.name in LINEAR + DATA:
            return path
    written = os.path.join(folder, "map-%s.exr" % fingerprint.digest_of(fingerprint.image_of(image)))
    if not os.path.exists(written):
        if not has_texels(image):
            raise ValueError("image %s: it has no texels" % image.name)
        if is_encoded(image) and filter_gap(stored_texels(image, True)) > MOST_APART:
            raise NotPlain  # Cycles interpolates the texels as they are encoded
        os.makedirs(folder, exist_ok=True)
        exr.write(written, linear_texels(image))
    return written


def plain(world, folder):
    """Keys of the request environment; raises NotPlain where Cycles must bake it."""
    if world is None:
        return DARK
    if not world.use_nodes:
        return {"radiance": list(world.color)}
    reader = Reader("TEX_ENVIRONMENT")
    background = background_of(world, reader)
    if background is None:
        return DARK
    colour, strength = (reader.value(background.inputs[name]) for name in ("Color", "Strength"))
    node = colour.image
    if strength.image or node and colour.channel is not None:
        raise NotPlain
    turn = turn_of(node, reader) if node else None
    if any(v.unknown or v.colours is not None for v in (colour, strength)):
        raise NotPlain
    if any(text for seen in reader.seen.values() for text in node_differences(seen)):
        raise NotPlain
    gain = numpy.array(colour.factor) * strength.factor[0]
    if gain.min() < 0:
        raise NotPlain
    if node is None:
        return {"radiance": gain.tolist()}
    rotate = AXES @ turn @ AXES.T @ MIDDLE
    return {"map": file_of(node.image, folder), "rotate": rotate.reshape(-1).tolist(), "gain": gain.tolist()}
