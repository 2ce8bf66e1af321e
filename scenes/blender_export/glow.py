"""Emission among Blender's shaders that is added to another shader, or mixed with it by a number."""

from dataclasses import dataclass

from . import versions


@dataclass(frozen=True)
class Glow:
    """Light of an Emission node beside that of the rest of a surface."""
    node: object
    share: float  # of the node's light


def added(first, second, layers):
    """The other node of an Add Shader with an Emission; None where there is none."""
    for emission, rest in ((second, first), (first, second)):
        if emission.type == "EMISSION":
            take(emission, 1, layers)
            return rest
    return None


def mixed(share, first, second, layers):
    """The other node of a Mix Shader with an Emission, of which the second counts by a share; None where there is none."""
    for emission, rest, part in ((second, first, share), (first, second, 1 - share)):
        if emission.type == "EMISSION":
            take(emission, part, layers)
            layers.scale *= 1 - part
            return rest
    return None


def take(emission, part, layers):
    layers.glows.append(Glow(emission, layers.cover * layers.scale * part))
    layers.nodes.append(emission)


def fits(layers, reader):
    """Whether a material can have the shader's light by the share that is left, and shine as well. A metal's reflectance at
    grazing angles has no such share, and holes do not shine."""
    shader = layers.shader
    if not layers.glows or shader.type != "BSDF_PRINCIPLED":
        return True
    if reader.number(shader.inputs["Alpha"]) != 1 or reader.number(versions.principled_input(shader, "Transmission")) != 0:
        return False
    return layers.scale == 1 or reader.number(shader.inputs["Metallic"]) == 0


def emission_sockets(shader):
    """Colour and strength of what a shader emits."""
    if shader.type == "EMISSION":
        return shader.inputs["Color"], shader.inputs["Strength"]
    return versions.principled_input(shader, "Emission"), shader.inputs["Emission Strength"]
