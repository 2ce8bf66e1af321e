# SPDX-License-Identifier: GPL-3.0-or-later
"""The world of a scene as the request environment has it: a map, how it is turned, and its gain.

An Environment Texture with a Mapping that turns or mirrors, times constants, is passed on as it is. Everything else is
baked to a map by Cycles (world_map).
"""

import os

import bpy
import numpy

from . import exr, fingerprint
from .blender_export.node_values import source
from .blender_export.pictures import linear_texels

AXES = numpy.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)    # of Blender to those of glTF
MIDDLE = numpy.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], float)  # the image's, to +X
LINEAR = ("Linear", "Non-Color", "Raw")
# What a map cannot know: a world that differs by who looks.
BY_VIEW = {"LIGHT_PATH", "CAMERA"}
BY_VIEW_SOCKETS = {"Window", "Camera", "Reflection"}


class NotPlain(Exception):
    """The nodes are not those of a map that is turned and multiplied."""


def constant(socket):
    if source(socket):
        raise NotPlain
    return socket.default_value


def background_of(world):
    """The Background node that is the whole world; None for nothing at all."""
    output = world.node_tree.get_output_node("CYCLES")
    if not output:
        return None
    if source(output.inputs["Volume"]):
        raise NotPlain
    found = source(output.inputs["Surface"])
    if found is None:
        return None
    if found.node.type != "BACKGROUND" or found.node.mute:
        raise NotPlain
    return found.node


def product_of(socket):
    """Colour of constants, and the node of the one Environment Texture, or None, that feed a socket."""
    feeding = source(socket)
    if feeding is None:
        return numpy.array(socket.default_value[:3]), None
    node = feeding.node
    if node.mute:
        raise NotPlain
    if node.type == "TEX_ENVIRONMENT" and feeding.name == "Color":
        return numpy.ones(3), node
    if node.type == "RGB":
        return numpy.array(feeding.default_value[:3]), None
    sockets = factors_of(node)
    (a, first), (b, second) = (product_of(s) for s in sockets)
    if first and second:
        raise NotPlain
    return a * b, first or second


def factors_of(node):
    """The two colours that a node multiplies."""
    if node.type == "MIX_RGB" and node.blend_type == "MULTIPLY" and not node.use_clamp:
        if constant(node.inputs[0]) == 1:
            return node.inputs[1], node.inputs[2]
    if node.type == "MIX" and node.data_type == "RGBA" and node.blend_type == "MULTIPLY" and not node.clamp_result:
        fac = next(s for s in node.inputs if s.enabled and s.name == "Factor")
        if constant(fac) == 1:
            return [s for s in node.inputs if s.enabled and s.name in ("A", "B")]
    raise NotPlain


def has_own_mapping(node):
    """Whether a texture turns or scales by settings that no editor shows, but scripts and old files set."""
    own = node.texture_mapping
    return (own.vector_type != "POINT" or own.use_min or own.use_max or any(own.translation) or any(own.rotation)
            or tuple(own.scale) != (1, 1, 1) or (own.mapping_x, own.mapping_y, own.mapping_z) != ("X", "Y", "Z"))


def turn_of(node):
    """3x3: directions of the map to those of Blender's world, for an Environment Texture."""
    if has_own_mapping(node):
        raise NotPlain
    feeding = source(node.inputs["Vector"])
    if feeding is None:
        return numpy.eye(3)
    if feeding.node.type == "TEX_COORD" and feeding.name == "Generated":
        return numpy.eye(3)
    mapping = feeding.node
    if mapping.type != "MAPPING" or mapping.mute:
        raise NotPlain
    before = source(mapping.inputs["Vector"])
    if before is None or before.node.type != "TEX_COORD" or before.name != "Generated":
        raise NotPlain
    kind = mapping.vector_type
    if kind in ("POINT", "TEXTURE") and any(constant(mapping.inputs["Location"])):
        raise NotPlain
    scale = numpy.array(constant(mapping.inputs["Scale"]), float)
    if not scale.all() or not numpy.allclose(abs(scale), abs(scale[0]), rtol=1e-5):
        raise NotPlain
    mirror = numpy.diag(numpy.sign(scale))
    rotation = numpy.array(constant(mapping.inputs["Rotation"]).to_matrix(), float)
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


def hidden_from(world):
    """What is left out of a world that some rays do not see."""
    rays = getattr(world, "cycles_visibility", None)
    kinds = [kind for kind in ("camera", "diffuse", "glossy") if rays and not getattr(rays, kind)]
    return ["world %s: hidden from rays: %s" % (world.name, ", ".join(kinds))] if kinds else []


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


def left_out(world, is_plain):
    """What the map of a world does not show."""
    if world is None:
        return []
    seen = [] if is_plain else by_view(world.node_tree)
    return hidden_from(world) + ["world %s: node %s: all see it as the camera does" % (world.name, name)
                                 for name in seen]


def file_of(image, folder):
    """An EXR or HDR file of an image's linear texels: its own, or one that is written."""
    if image is None:
        raise NotPlain
    if image.source not in ("FILE", "GENERATED"):
        raise NotPlain
    path = bpy.path.abspath(image.filepath, library=image.library)
    own = (image.source == "FILE" and not image.is_dirty and not image.packed_file and os.path.isfile(path)
           and path.lower().endswith((".exr", ".hdr")) and image.colorspace_settings.name in LINEAR)
    if own:
        return path
    if image.source == "FILE" and not image.packed_file and not os.path.isfile(path):
        raise FileNotFoundError("image %s: no file %s" % (image.name, path))
    written = os.path.join(folder, "map-%s.exr" % fingerprint.digest_of(fingerprint.image_of(image)))
    if not os.path.exists(written):
        if not image.has_data and not len(image.pixels) or 0 in tuple(image.size):
            raise ValueError("image %s: it has no texels" % image.name)
        os.makedirs(folder, exist_ok=True)
        exr.write(written, linear_texels(image))
    return written


def plain(world, folder):
    """Keys of the request environment; raises NotPlain where Cycles must bake it."""
    if world is None:
        return {"radiance": [0, 0, 0]}
    if not world.use_nodes:
        return {"radiance": list(world.color)}
    background = background_of(world)
    if background is None:
        return {"radiance": [0, 0, 0]}
    colour, node = product_of(background.inputs["Color"])
    gain = colour * constant(background.inputs["Strength"])
    if node is None:
        return {"radiance": numpy.maximum(gain, 0).tolist()}
    if node.projection != "EQUIRECTANGULAR" or gain.min() < 0:
        raise NotPlain
    rotate = AXES @ turn_of(node) @ AXES.T @ MIDDLE
    return {"map": file_of(node.image, folder), "rotate": rotate.reshape(-1).tolist(), "gain": gain.tolist()}
