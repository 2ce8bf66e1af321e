# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes by Blender's names, made of planes by ours."""

from dataclasses import dataclass

import numpy

from . import light_groups

SKY_DEPTH = 1e10  # as of Cycles
# AOVs of the ray through a pixel's centre, as of Cycles: a mean of places, or with the sky, is none.
OF_CENTRE = ("axial_depth", "position")


@dataclass(frozen=True)
class Pass:
    name: str       # Blender's
    flag: str       # of the view layer, or of an add-on's settings in it
    channels: str
    kind: str       # of its socket: COLOR, VECTOR or VALUE
    aovs: tuple     # that it is made of
    make: object    # its planes (channels, height, width) of a Picture


def light(part, colour):
    """Light without the colour of the surface, as Cycles has it."""
    def make(picture):
        below = picture.planes(colour)
        return numpy.divide(picture.planes(part), below, out=numpy.zeros_like(below), where=below > 0)
    return make


def normal(picture):
    return z_up(picture.planes("normal"))


def position(picture):
    return z_up(picture.planes("position"))


def z_up(planes):
    x, y, z = planes
    return numpy.stack((x, -z, y))


def depth(picture):
    return numpy.where(hit(picture), picture.planes("axial_depth"), numpy.float32(SKY_DEPTH))


def hit(picture):
    """Whether the ray through a pixel's centre meets the set."""
    return picture.planes("axial_depth") > 0


def emission(picture):
    """The AOV has the sky, too."""
    return picture.planes("emission") - picture.planes("environment")


def plain(name):
    return lambda picture: picture.planes(name)


def albedo(picture):
    return picture.planes("diffuse_color") + picture.planes("glossy_color")


DENOISING = "cycles.denoising_store_passes"  # Cycles' Denoising Data, by whose names the compositor's nodes are made
PASSES = (
    Pass("Depth", "use_pass_z", "Z", "VALUE", ("axial_depth",), depth),
    Pass("Normal", "use_pass_normal", "XYZ", "VECTOR", ("normal",), normal),
    Pass("Position", "use_pass_position", "XYZ", "VECTOR", ("position",), position),
    Pass("DiffDir", "use_pass_diffuse_direct", "RGB", "COLOR", ("diffuse_direct", "diffuse_color"),
         light("diffuse_direct", "diffuse_color")),
    Pass("DiffInd", "use_pass_diffuse_indirect", "RGB", "COLOR", ("diffuse_indirect", "diffuse_color"),
         light("diffuse_indirect", "diffuse_color")),
    Pass("DiffCol", "use_pass_diffuse_color", "RGB", "COLOR", ("diffuse_color",), plain("diffuse_color")),
    Pass("GlossDir", "use_pass_glossy_direct", "RGB", "COLOR", ("glossy_direct", "glossy_color"),
         light("glossy_direct", "glossy_color")),
    Pass("GlossInd", "use_pass_glossy_indirect", "RGB", "COLOR", ("glossy_indirect", "glossy_color"),
         light("glossy_indirect", "glossy_color")),
    Pass("GlossCol", "use_pass_glossy_color", "RGB", "COLOR", ("glossy_color",), plain("glossy_color")),
    Pass("Emit", "use_pass_emit", "RGB", "COLOR", ("emission", "environment"), emission),
    Pass("Env", "use_pass_environment", "RGB", "COLOR", ("environment",), plain("environment")),
    Pass("Noisy Image", DENOISING, "RGBA", "COLOR", (), lambda picture: picture.combined()),
    Pass("Denoising Normal", DENOISING, "XYZ", "VECTOR", ("normal",), normal),
    Pass("Denoising Albedo", DENOISING, "RGB", "COLOR", ("diffuse_color", "glossy_color"), albedo),
    Pass("Denoising Depth", DENOISING, "Z", "VALUE", ("depth",), plain("depth")),
)
# Ours alone; its flag is in the view layer's own settings.
VARIANCE = Pass("Noise Variance", "use_pass_variance", "Y", "VALUE", ("variance",), plain("variance"))
# Flags of the view layer for passes that only Cycles has.
WITHOUT = {"use_pass_mist": "Mist", "use_pass_vector": "Vector", "use_pass_uv": "UV",
           "use_pass_object_index": "Object Index", "use_pass_material_index": "Material Index",
           "use_pass_transmission_direct": "Transmission Direct",
           "use_pass_transmission_indirect": "Transmission Indirect",
           "use_pass_transmission_color": "Transmission Color", "use_pass_subsurface_direct": "Subsurface Direct",
           "use_pass_subsurface_indirect": "Subsurface Indirect", "use_pass_subsurface_color": "Subsurface Color",
           "use_pass_shadow": "Shadow", "use_pass_ambient_occlusion": "Ambient Occlusion",
           "use_pass_cryptomatte_object": "Cryptomatte Object",
           "use_pass_cryptomatte_material": "Cryptomatte Material",
           "use_pass_cryptomatte_asset": "Cryptomatte Asset"}


def asks(layer, flag):
    """Whether a flag is on; one of an add-on that is not there is off."""
    for name in flag.split("."):
        layer = getattr(layer, name, None)
    return bool(layer)


def group_pass(group):
    name = light_groups.PREFIX + group
    return Pass(name, "", "RGB", "COLOR", (), lambda picture: picture.group(name))


def wanted(layer):
    """Passes beside Combined of a view layer."""
    found = [p for p in PASSES if asks(layer, p.flag)]
    groups = [group_pass(name) for name in light_groups.names(layer)]
    return found + [VARIANCE] * layer.shadowcache.use_pass_variance + groups


def left_out(layer):
    """What is not made of the passes that a view layer wants."""
    return ["pass %s" % name for flag, name in WITHOUT.items() if getattr(layer, flag, False)]


def aovs_of(passes):
    """Those of all camera rays, and those of the one through the centre."""
    names = {name for p in passes for name in p.aovs}
    return sorted(names - set(OF_CENTRE)), sorted(names & set(OF_CENTRE))


class Picture:
    """Planes that were rendered, by AOV."""

    def __init__(self, names, planes):
        self.rows = {}
        for name, plane in zip(names, planes):
            of = name.rsplit(".", 1)[0] if "." in name else "picture"
            if name != "A":
                self.rows.setdefault(of, []).append(plane)
        self.alpha = planes[names.index("A")] if "A" in names else None

    def add(self, other):
        """Takes the AOVs of another picture that this one has not."""
        self.rows = {**other.rows, **self.rows}

    def planes(self, name):
        return numpy.stack(self.rows[name])

    def group(self, name):
        """Of a light group; black where nothing of it shines."""
        return self.planes(name) if name in self.rows else numpy.zeros_like(self.planes("picture"))

    def combined(self):
        colour = self.planes("picture")
        alpha = numpy.ones(colour.shape[1:], numpy.float32) if self.alpha is None else self.alpha
        return numpy.concatenate((colour, alpha[None]))

    def fill(self, layer, passes):
        """Puts the pixels into the passes of a render's result, as far as their AOVs are there."""
        of_all = ("Combined", Picture.combined, ("picture",))
        for name, make, aovs in (of_all, *((p.name, p.make, p.aovs) for p in passes)):
            found = next((p for p in layer.passes if p.name == name), None)
            if found and all(aov in self.rows for aov in aovs):
                # Rows from the bottom, channels of a pixel side by side.
                values = make(self)[:, ::-1].transpose(1, 2, 0)
                found.rect.foreach_set(numpy.ascontiguousarray(values, numpy.float32).reshape(-1, found.channels))
