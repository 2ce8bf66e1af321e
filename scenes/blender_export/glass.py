"""Panes of glass among Blender's shaders: what lets light pass straight, tinted, and mirrors the rest.

Cycles shows the same where light passes a Transparent BSDF. Its glass refracts light instead, which the report says.
"""

from dataclasses import dataclass, field

from . import glow, versions
from .node_values import Value, feed_of, source

STRAIGHT = "glass: light passes straight, as through a thin pane; Cycles refracts it, and its shadow rays end there"
BEHIND = "Fresnel: from behind a face, Cycles mirrors as from inside the glass; here both sides mirror alike"
SHADOW_TRICK = "Is Shadow Ray: here light to surfaces behind the glass loses what the glass mirrors"
CONSTANT = "Mix of Transparent and Glossy by a number: seen from the side, the glass mirrors more here"
GLOSSY = "ShaderNodeBsdfGlossy"  # from 4.0 on it is another node, with anisotropy
STANDARD_REFLECTANCE = 0.04  # of glTF, at normal incidence, where no index is stated


@dataclass
class Pane:
    """Glass without thickness."""
    colour: Value             # factor of what passes
    index: object = 1.5       # of refraction; None: no constant
    specular: float = 1       # share of what the index says that is mirrored; 0: nothing is
    constant: float = 0       # share of the light that is mirrored from all sides, in place of that
    roughness: Value = Value((0,))


@dataclass
class Layers:
    """What a shader is below the Mix and Add Shaders of transparent parts and of emission."""
    shader: object = None     # the node of the rest; None: it is the pane
    pane: object = None
    cover: float = 1          # share of the surface that is not transparent
    scale: float = 1          # share of the rest's light, where the surface is not transparent
    glows: list = field(default_factory=list)    # glow.Glow, of the surface with its transparent part
    nodes: list = field(default_factory=list)    # that were read
    remarks: list = field(default_factory=list)  # for *Not Rendered*: texts above


def is_clear(node):
    """Whether a node is a Transparent BSDF of white, without links."""
    return node.type == "BSDF_TRANSPARENT" and not feed_of(node.inputs[0]) and \
        tuple(node.inputs[0].default_value)[:3] == (1, 1, 1)


def index_of(node, reader):
    """The constant index of refraction of a node, or None."""
    return reader.number(node.inputs["IOR"])


def is_shadow_ray(output):
    """Whether a factor is 1 for shadow rays: Light Path's, or the greater of such and others of its outputs."""
    node = output.node
    if node.type == "LIGHT_PATH":
        return output.name == "Is Shadow Ray"
    if node.type != "MATH" or node.operation not in ("MAXIMUM", "ADD"):
        return False
    feeding = [source(socket) for socket in node.inputs[:2]]
    return all(one and (one.node.type == "LIGHT_PATH" or is_shadow_ray(one)) for one in feeding) and \
        any(is_shadow_ray(one) for one in feeding)


def layers_of(node, reader):
    """Layers of a shader, or None where it is something else than a pane and mixes with Transparent and Emission."""
    layers = Layers()
    while node.type in ("MIX_SHADER", "ADD_SHADER"):
        sides = [source(socket) for socket in node.inputs if socket.type == "SHADER"]
        if None in sides:
            return None
        first, second = (side.node for side in sides)
        layers.nodes.append(node)
        if node.type == "ADD_SHADER":
            node = glow.added(first, second, layers)
            if node is None:
                return None
            continue
        feeding = source(node.inputs[0])
        share = reader.number(node.inputs[0])
        if share is not None:
            share = min(max(share, 0), 1)
            node = mixed_by_number(share, first, second, layers, reader)
        elif is_shadow_ray(feeding) and second.type == "BSDF_TRANSPARENT" and is_glass(first, reader):
            layers.remarks.append(SHADOW_TRICK)
            node = first
        else:
            node = mixed_by_angle(feeding.node, first, second, layers, reader)
        if node is None:
            return layers if layers.pane and not layers.glows else None
    if node.type == "BSDF_TRANSPARENT":
        layers.pane = Pane(reader.value(node.inputs["Color"]), specular=0)
    elif node.type == "BSDF_GLASS":
        layers.pane = Pane(reader.value(node.inputs["Color"]), index=index_of(node, reader),
                           roughness=roughness_of(node, reader))
        layers.remarks.append(STRAIGHT)
    else:
        layers.shader = node
        return layers
    layers.nodes.append(node)
    return None if layers.glows else layers


def mixed_by_number(share, first, second, layers, reader):
    """The node that a mix comes down to; None if it does not, or is a pane."""
    if share in (0, 1):
        return second if share else first
    if is_clear(first):
        if second.bl_idname != GLOSSY:
            layers.cover *= share
            layers.nodes.append(first)
            return second
    elif is_clear(second):
        layers.cover *= 1 - share
        layers.nodes.append(second)
        return first
    rest = glow.mixed(share, first, second, layers)
    if rest:
        return rest
    if first.type == "BSDF_TRANSPARENT" and mirrors_white(second, reader):
        layers.pane = Pane(reader.value(first.inputs["Color"]), constant=share, roughness=roughness_of(second, reader))
        layers.nodes += [first, second]
        layers.remarks.append(CONSTANT)
    return None


def mixed_by_angle(factor, first, second, layers, reader):
    """Notes the pane of a mix by a Fresnel factor. There is no node below it."""
    if factor.type != "FRESNEL" or feed_of(factor.inputs["Normal"]):
        return
    index = index_of(factor, reader)
    if index is None or first.type != "BSDF_TRANSPARENT" or not mirrors_white(second, reader):
        return
    layers.pane = Pane(reader.value(first.inputs["Color"]), index=index, roughness=roughness_of(second, reader))
    layers.nodes += [factor, first, second]
    layers.remarks.append(BEHIND)


def mirrors_white(node, reader):
    """Whether a node is a Glossy BSDF that reflects all colours alike."""
    if node.bl_idname != GLOSSY:
        return False
    colour = reader.value(node.inputs["Color"])
    return not (colour.image or colour.colours is not None or colour.unknown) and set(colour.factor) == {1}


def is_glass(node, reader):
    """Whether a node, below mixes, is glass of any kind."""
    below = layers_of(node, reader)
    if below is None:
        return False
    if below.shader is None:
        return below.pane.specular > 0
    return below.shader.type == "BSDF_PRINCIPLED" and transmits(below.shader, reader)


def transmits(principled, reader):
    value = reader.value(versions.principled_input(principled, "Transmission"))
    return bool(value.image or value.colours is not None or value.unknown or value.factor[0] > 0)


def roughness_of(node, reader):
    if node.distribution == "SHARP":
        return Value((0,))
    return reader.value(node.inputs["Roughness"])


def reflectance(index):
    """At normal incidence."""
    return ((index - 1) / (index + 1)) ** 2
