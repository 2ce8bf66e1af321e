"""What feeds a socket of a shader: constants times one image times one colour of the mesh."""

import math
from dataclasses import dataclass

RED, GREEN, BLUE, ALPHA = range(4)


@dataclass
class Value:
    """factor (3 numbers, or 1) times an image's channel, or its colour, times a colour attribute."""
    factor: tuple
    image: object = None      # the node of the image
    channel: object = None    # of the image; None: its colour
    colours: object = None    # name of the attribute, "" for the active one; None: none
    unknown: object = None    # name of a node that cannot be expressed; the factor is then the socket's constant


def source(socket):
    """The socket that feeds this one, through reroutes; None if it is not linked."""
    while socket.is_linked and not socket.links[0].is_muted:
        socket = socket.links[0].from_socket
        if socket.node.type != "REROUTE":
            return socket
        socket = socket.node.inputs[0]
    return None


def product(a, b):
    """None if both have an image, or both a colour of the mesh."""
    if (a.image and b.image) or (a.colours is not None and b.colours is not None):
        return None
    one, other = (a, b) if a.image else (b, a)
    return Value(tuple(x * y for x, y in zip(a.factor, b.factor)), one.image, one.channel,
                 one.colours if one.colours is not None else other.colours, a.unknown or b.unknown)


def attribute_name(node):
    if node.type == "VERTEX_COLOR":
        return node.layer_name
    return node.attribute_name if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY" else None


def factors(node, numbers):
    """The sockets, of numbers or of colours, that a node multiplies; empty if it does anything else."""
    if numbers:
        return list(node.inputs[:2]) if node.type == "MATH" and node.operation == "MULTIPLY" else []
    if node.type == "MIX_RGB" and node.blend_type == "MULTIPLY":
        weight, sockets = node.inputs[0], node.inputs[1:3]
    elif node.type == "MIX" and node.data_type == "RGBA" and node.blend_type == "MULTIPLY":
        weight, sockets = node.inputs[0], [s for s in node.inputs if s.type == "RGBA"]
    else:
        return []
    return list(sockets) if not weight.is_linked and weight.default_value == 1 else []


def colour_of(socket):
    """Of a colour socket."""
    feeding = source(socket)
    if feeding is None:
        return Value(tuple(socket.default_value)[:3])
    node = feeding.node
    if node.type == "RGB":
        return Value(tuple(feeding.default_value)[:3])
    if node.type == "TEX_IMAGE" and node.image and feeding.name == "Color":
        return Value((1, 1, 1), image=node)
    if attribute_name(node) is not None and feeding.name == "Color":
        return Value((1, 1, 1), colours=attribute_name(node))
    return multiplied(node, colour_of) or Value(tuple(socket.default_value)[:3], unknown=node.bl_label)


def multiplied(node, read):
    sockets = factors(node, read is number_of)
    return product(*(read(s) for s in sockets)) if len(sockets) == 2 else None


def number_of(socket):
    """Of a socket with a single number; a colour that feeds one counts by its red, as greys do."""
    feeding = source(socket)
    if feeding is None:
        return Value((socket.default_value,))
    node = feeding.node
    if node.type == "VALUE":
        return Value((feeding.default_value,))
    if node.type == "TEX_IMAGE" and node.image:
        return Value((1,), image=node, channel=ALPHA if feeding.name == "Alpha" else RED)
    if node.type in ("SEPARATE_COLOR", "SEPRGB") and getattr(node, "mode", "RGB") == "RGB":
        inner = source(node.inputs[0])
        if inner and inner.node.type == "TEX_IMAGE" and inner.node.image and inner.name == "Color":
            return Value((1,), image=inner.node, channel=list(node.outputs).index(feeding))
    if attribute_name(node) is not None and feeding.name == "Alpha":
        return Value((1,), colours=attribute_name(node))
    return multiplied(node, number_of) or Value((socket.default_value,), unknown=node.bl_label)


def placement(node):
    """Name of an image node's texture coordinates ("" for the active ones), the KHR_texture_transform of a Mapping
    node (None without), and the name of a node that cannot be expressed (None without)."""
    feeding, transform = source(node.inputs["Vector"]), None
    if feeding and feeding.node.type == "MAPPING":
        transform = texture_transform(feeding.node)
        if transform is None:
            return "", None, "Mapping"
        feeding = source(feeding.node.inputs["Vector"])
    if feeding is None or (feeding.node.type == "TEX_COORD" and feeding.name == "UV"):
        return "", transform, None
    if feeding.node.type == "UVMAP":
        return feeding.node.uv_map, transform, None
    if feeding.node.type == "ATTRIBUTE":
        return feeding.node.attribute_name, transform, None
    label = feeding.node.bl_label + (" " + feeding.name if feeding.node.type == "TEX_COORD" else "")
    return "", transform, label


def texture_transform(node):
    """u' = offset + rotation scale u, in Blender's axes; glTF's t points downwards, t = 1 - v."""
    if node.vector_type not in ("POINT", "VECTOR") or any(s.is_linked for s in node.inputs if s.name != "Vector"):
        return None
    turn, scale = node.inputs["Rotation"].default_value, node.inputs["Scale"].default_value
    if turn[0] or turn[1]:
        return None
    moved = node.inputs["Location"].default_value if node.vector_type == "POINT" else (0, 0, 0)
    sine, cosine = math.sin(turn[2]), math.cos(turn[2])
    return {"offset": [moved[0] - sine * scale[1], 1 - moved[1] - cosine * scale[1]],
            "rotation": turn[2], "scale": [scale[0], scale[1]]}


def surface_of(material):
    """The shader that a material's surface is, the socket that it comes from; None without."""
    tree = material.node_tree
    output = tree.get_output_node("CYCLES") or tree.get_output_node("ALL")
    return (source(output.inputs["Surface"]), output) if output else (None, None)
