"""Lamps as KHR_lights_punctual has them, with what it has no words for in `extras`, as Shadowcache reads it.

Strengths are those of Cycles: watts of a lamp that shines to all sides alike, or irradiance of a sun.
"""

import math

import bpy

from . import versions
from .differences import differences, node_differences
from .node_values import Reader, output_of, source

EXTENSION = "KHR_lights_punctual"
SHAPES = {"SQUARE": "rectangle", "RECTANGLE": "rectangle", "DISK": "ellipse", "ELLIPSE": "ellipse"}
OF_CAMERA = "hidden from the camera"
THROUGH_GLASS = "light hidden from the camera: seen through glass in Cycles, not here"
NO_SPREAD = math.pi - 1e-6
# Angles beyond which light, or the look, of a lamp differs from Cycles by 1 per cent.
WIDE_SUN, WIDE_SEEN_SUN, NARROW_SPREAD = math.radians(70), math.radians(15), math.radians(3)
UNEVEN_SUN = "wide; Cycles has a sun brighter towards its edge, here it is even"


def entry(thing, report):
    """A light of a glTF document, of an evaluated object; None if it is none. name_differences() names what of the lamp is
    not rendered, but for its nodes."""
    lamp = thing.data
    if lamp.type == "AREA" and lamp.cycles.is_portal:
        return None
    light = [c * lamp.energy * s for c, s in zip(lamp.color, strength_of(lamp, report))]
    if min(light) < 0:
        report.add("light %s: light below 0" % thing.name)
        light = [max(c, 0) for c in light]
    most = max(light)
    made = {"name": thing.name, "color": [c / most for c in light] if most else [0, 0, 0]}
    made.update(OF_TYPE[lamp.type](thing, most))
    if is_seen(thing):
        made["extras"]["camera"] = True
    return made


def name_differences(thing, report):
    """Adds what of a lamp is not rendered. Lamps that no camera sees are the usual ones."""
    found = [text for text in differences(thing) if text != OF_CAMERA] + list(differences(thing.data))
    if is_seen(thing) and not thing.data.cycles.use_multiple_importance_sampling:
        found.append("seen by the camera, as in Cycles where a lamp has Multiple Importance")
    if thing.data.type == "AREA" and has_shear(thing):
        found.append("sheared")
    if thing.data.type == "AREA" and thing.data.spread < NARROW_SPREAD:
        found.append("a narrow spread; Cycles' rounding changes its light")
    if thing.data.type == "SUN" and thing.data.angle > (WIDE_SEEN_SUN if is_seen(thing) else WIDE_SUN):
        found.append(UNEVEN_SUN)
    if not all(axis.length for axis in thing.matrix_world.to_3x3().col):
        found.append("a scale of 0, which counts otherwise in Cycles")
    for text in found:
        report.add("light %s: %s" % (thing.name, text))


def is_seen(thing):
    """Whether the camera sees a lamp: Cycles shows those that have an extent."""
    return thing.visible_camera and has_extent(thing)


def is_seen_through_glass(thing):
    """Whether rays that glass refracted see in Cycles a lamp that the camera does not see."""
    return thing.visible_transmission and not thing.visible_camera and has_extent(thing) and \
        thing.data.cycles.use_multiple_importance_sampling


def has_extent(thing):
    return getattr(thing.data, EXTENT[thing.data.type]) > 0


def has_shear(thing):
    x, y, _ = thing.matrix_world.to_3x3().col
    return abs(x.dot(y)) > 1e-5 * x.length * y.length


def strength_of(lamp, report):
    """Factors by a lamp's nodes: colour times strength of an Emission."""
    output = output_of(lamp.node_tree) if lamp.use_nodes and lamp.node_tree else None
    if not lamp.use_nodes:
        return 1, 1, 1
    feeding = source(output.inputs["Surface"]) if output else None
    if feeding is None:
        return 0, 0, 0
    node = feeding.node
    if node.type != "EMISSION":
        report.add("light %s: node %s" % (lamp.name, node.bl_label))
        return 1, 1, 1
    reader = Reader()
    colour, strength = (reader.value(node.inputs[name]) for name in ("Color", "Strength"))
    for value, name in ((colour, "Color"), (strength, "Strength")):
        if value.unknown:
            report.add("light %s: %s: node %s" % (lamp.name, name, value.unknown))
        if value.image or value.colours is not None:
            report.add("light %s: %s that varies" % (lamp.name, name))
    for text in node_differences(node):
        report.add("light %s: %s" % (lamp.name, text))
    return tuple(c * strength.factor[0] for c in colour.factor)


def of_point(thing, power):
    return {"type": "point", "intensity": power / (4 * math.pi), "extras": {"radius": thing.data.shadow_soft_size}}


def of_sun(thing, power):
    """Cycles spreads a sun's light over a flat disc, of which directions at its edge are farther."""
    angle = min(thing.data.angle, math.pi)
    cosine = math.cos(angle / 2)
    return {"type": "directional", "intensity": power * 2 * cosine / (1 + cosine), "extras": {"angle": angle}}


def of_spot(thing, power):
    """The falloff is over a share of the cone's height, which is the cosine. An inner angle that rounding makes greater than
    the outer one would be refused."""
    lamp = thing.data
    outer = min(lamp.spot_size / 2, math.pi / 2)
    height = math.cos(outer)
    inner = math.acos(min(height + (1 - height) * lamp.spot_blend, 1))
    return {"type": "spot", "intensity": power / (4 * math.pi),
            "spot": {"innerConeAngle": min(inner, outer), "outerConeAngle": outer},
            "extras": {"radius": lamp.shadow_soft_size, "falloff": versions.falloff_of_spots(bpy.app.version)}}


def of_area(thing, power):
    """The node's scale is that of the area, and not of its power; neither is its spread."""
    lamp = thing.data
    size = [lamp.size, lamp.size if lamp.shape in ("SQUARE", "DISK") else lamp.size_y]
    intensity = power / 4 if all(size) else 0
    extras = {"shape": SHAPES[lamp.shape], "size": [max(s, 1e-9) for s in size]}
    if lamp.spread < NO_SPREAD:
        half = lamp.spread / 2
        intensity /= 1 - half / math.tan(half)
        extras["spread"] = lamp.spread
    return {"type": "spot", "intensity": intensity, "spot": {"outerConeAngle": math.pi / 2}, "extras": extras}


EXTENT = {"POINT": "shadow_soft_size", "SUN": "angle", "SPOT": "shadow_soft_size", "AREA": "size"}
OF_TYPE = {"POINT": of_point, "SUN": of_sun, "SPOT": of_spot, "AREA": of_area}
