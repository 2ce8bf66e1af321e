"""What feeds a socket of a shader: constants times one image times one colour of the mesh."""

from dataclasses import dataclass, replace

from . import blackbody

RED, GREEN, BLUE, ALPHA = range(4)
LUMINANCE = (0.2126729, 0.7151522, 0.0721750)  # of Rec.709, as Cycles makes a number of a colour
MISSING = (1, 0, 1)  # what Cycles shows of an image that is not there


@dataclass(frozen=True)
class Value:
    """factor (3 numbers, or 1) times an image's channel, or its colour, times a colour attribute."""
    factor: tuple
    image: object = None      # the node of the image
    channel: object = None    # of the image: a number, or weights of its colours; None: its colour
    colours: object = None    # name of the attribute, "" for the active one; None: none
    unknown: object = None    # name of a node that cannot be expressed; the factor is then the socket's constant


@dataclass(frozen=True)
class Feed:
    """What feeds a socket through reroutes and muted nodes."""
    output: object  # of a node; None: nothing, which is 0
    kinds: tuple    # of the sockets between that convert the value, from the output on


def link_of(socket):
    """The link of an input that counts, or None."""
    return next((link for link in socket.links if link.is_valid and not link.is_muted and link.from_socket.enabled), None)


def feed_of(socket):
    """As Cycles follows links: a muted node hands on what Blender links inside of it. None: the socket's own value."""
    kinds = []
    link = link_of(socket)
    while link:
        output, node = link.from_socket, link.from_node
        if node.type == "REROUTE":
            inner = node.inputs[0]
        elif node.mute:
            inner = next((inside.from_socket for inside in node.internal_links if inside.to_socket == output), None)
        else:
            return Feed(output, tuple(reversed(kinds)))
        if inner is None:
            break
        kinds.append(inner.type)
        link = link_of(inner)
    return Feed(None, ()) if kinds else None


def source(socket):
    """The output that feeds an input, or None."""
    feed = feed_of(socket)
    return feed.output if feed else None


def constant(socket):
    """An input's own value; numbers of a colour, or a number."""
    value = socket.default_value
    return tuple(value)[:3] if hasattr(value, "__len__") else (value,)


def converted(value, kind):
    """A value as a socket of a kind takes it; None if that cannot be expressed."""
    if kind != "VALUE":
        if len(value.factor) == 3:
            return value
        return None if value.colours is not None else replace(value, factor=value.factor * 3)
    if len(value.factor) == 1:
        return value
    weights = tuple(w * f for w, f in zip(LUMINANCE, value.factor))
    if value.colours is not None:
        return None
    if value.image and value.channel is None:
        return replace(value, factor=(1,), channel=weights)
    return replace(value, factor=(sum(weights),))


def product(a, b):
    """None if both have an image, or both a colour of the mesh."""
    if (a.image and b.image) or (a.colours is not None and b.colours is not None):
        return None
    one, other = (a, b) if a.image else (b, a)
    return Value(tuple(x * y for x, y in zip(a.factor, b.factor)), one.image, one.channel,
                 one.colours if one.colours is not None else other.colours, a.unknown or b.unknown)


def attribute_name(node):
    """Of a node that reads an attribute of the mesh; None for any other."""
    if node.type == "VERTEX_COLOR":
        return node.layer_name
    return node.attribute_name if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY" else None


def factors(node):
    """The sockets that a node multiplies; empty if it does anything else."""
    if node.type == "MATH" and node.operation == "MULTIPLY":
        return list(node.inputs[:2])
    if node.type == "MIX_RGB" and node.blend_type == "MULTIPLY":
        weight, sockets = node.inputs[0], node.inputs[1:3]
    elif node.type == "MIX" and node.data_type == "RGBA" and node.blend_type == "MULTIPLY":
        weight, sockets = node.inputs[0], [s for s in node.inputs if s.type == "RGBA"]
    else:
        return []
    return list(sockets) if not link_of(weight) and weight.default_value == 1 else []


class Reader:
    """Reads values, and remembers the nodes that it has read: what else these do is for differences.py."""

    def __init__(self, image="TEX_IMAGE"):
        self.image = image  # the type of nodes that look images up
        self.seen = {}

    def see(self, node):
        self.seen[node.name] = node
        return node

    def value(self, socket):
        """Of a socket with a colour, or with a number."""
        feed = feed_of(socket)
        if feed is None:
            return Value(constant(socket))
        if feed.output is None:
            return Value((0,) * len(constant(socket)))
        value = self._output(feed.output)
        for kind in (*feed.kinds, socket.type):
            value = value and converted(value, kind)
        if value is None:
            return Value(constant(socket), unknown=feed.output.node.bl_label)
        return value

    def number(self, socket):
        """A constant that feeds a socket with a number, or None."""
        value = self.value(socket)
        return None if value.image or value.colours is not None or value.unknown else value.factor[0]

    def _output(self, output):
        """Of an output; None if it cannot be expressed."""
        node = output.node
        value = self._known(node, output)
        if value is not None:
            self.see(node)
        return value

    def _known(self, node, output):
        if node.type == "RGB":
            return Value(tuple(output.default_value)[:3])
        if node.type == "VALUE":
            return Value((output.default_value,))
        if node.type == "BLACKBODY":
            kelvins = self.number(node.inputs["Temperature"])
            return None if kelvins is None else Value(blackbody.colour(kelvins))
        if node.type == self.image:
            if not node.image:
                return Value(MISSING if output.name == "Color" else (1,))
            return Value((1, 1, 1), image=node) if output.name == "Color" else Value((1,), image=node, channel=ALPHA)
        if attribute_name(node) is not None and output.name in ("Color", "Alpha"):
            return Value((1, 1, 1) if output.name == "Color" else (1,), colours=attribute_name(node))
        if node.type in ("SEPARATE_COLOR", "SEPRGB") and getattr(node, "mode", "RGB") == "RGB":
            return self._channel(self.value(node.inputs[0]), list(node.outputs).index(output))
        sockets = factors(node)
        return product(*(self.value(socket) for socket in sockets)) if len(sockets) == 2 else None

    @staticmethod
    def _channel(colour, number):
        """One of a colour's three numbers."""
        if colour.colours is not None:
            return None
        own = colour.image and colour.channel is None
        return replace(colour, factor=(colour.factor[number],), channel=number if own else colour.channel)


def output_of(tree):
    """The output node that Cycles renders, of a material, a world or a lamp; None, as nothing is, where it is muted."""
    output = tree.get_output_node("CYCLES")
    return None if output and output.mute else output


def surface_of(material):
    """The output that a material's surface is, or None, and the node Material Output, or None."""
    output = output_of(material.node_tree)
    return (source(output.inputs["Surface"]), output) if output else (None, None)
