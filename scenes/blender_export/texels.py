"""Texels of Blender's images as Cycles' shaders see them, and between them.

Cycles filters what is stored: bytes that are sRGB-encoded, colours times their opacity where no Alpha is asked for. A
renderer of glTF filters decoded colours. Where that makes a difference, an image is made finer, from Cycles' filter.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy

from .image_files import unlike_blender

ENCODED, LINEAR, DATA = ("sRGB",), ("Linear",), ("Non-Color", "Raw")
OF_FLOATS = ("OPEN_EXR", "OPEN_EXR_MULTILAYER", "HDR")
MOST_TEXELS = 1 << 22   # of an image that is made finer
MOST_APART = 0.005      # share of the mean by which filters differ where an image stays as it is,
LEAST_APART = 0.002     # and where it is made finer
CUBIC_FINER = 8         # times, which splits a cubic filter finely enough for a linear one
SAMPLED = 512           # rows and columns that are looked at


def decode_srgb(x):
    return numpy.where(x <= 0.04045, x / 12.92, ((numpy.maximum(x, 0) + 0.055) / 1.055) ** 2.4)


def encode_srgb(x):
    return numpy.where(x <= 0.0031308, x * 12.92, 1.055 * numpy.maximum(x, 0) ** (1 / 2.4) - 0.055)


def is_used(output):
    """Whether an output leads to an output of the material: Cycles drops all other nodes, and their links."""
    todo, seen = [output], set()
    while todo:
        for link in todo.pop().links:
            node = link.to_node
            if link.is_muted or node.name in seen:
                continue
            if node.type.startswith("OUTPUT"):
                return True
            seen.add(node.name)
            todo += node.outputs
    return False


@dataclass(frozen=True)
class Lookup:
    """How an image node looks its image up."""
    name: str             # of the image
    is_alone: bool        # no Alpha is asked for: colours are times the opacity
    interpolation: str
    extension: str

    @staticmethod
    def of(node):
        return Lookup(node.image.name_full, not any(is_used(s) for s in node.outputs if s.name == "Alpha"),
                      node.interpolation, getattr(node, "extension", "REPEAT"))


def pixels_of(image):
    """RGBA as Blender has it, rows from the top."""
    width, height = image.size
    texels = numpy.empty(width * height * 4, numpy.float32)
    image.pixels.foreach_get(texels)
    return texels.reshape(height, width, 4)[::-1]


def is_encoded(image):
    """Whether Cycles filters an image's texels as they are encoded: floats that Blender hands over are linear."""
    handed_over = image.is_float and (image.source == "GENERATED" or image.packed_file)
    return image.colorspace_settings.name in ENCODED and not handed_over


def has_texels(image):
    return bool(image.has_data or len(image.pixels)) and 0 not in tuple(image.size)


def unknown_of(image):
    """What of an image's storage is not read as Cycles does; empty if all is, or nothing is there."""
    if not has_texels(image):
        return ""
    if (not image.is_float or is_of_integers(image)) and image.colorspace_settings.name not in ENCODED + LINEAR + DATA:
        return "colour space %s" % image.colorspace_settings.name
    return unknown_alpha_of(image) or unlike_blender(image)


def unknown_alpha_of(image):
    """What of an image's opacity is not read as Cycles does; empty where all of it is 1."""
    if image.source != "FILE" or not has_opacity(image):
        return ""
    if image.alpha_mode == "PREMUL" and not is_of_floats(image):
        words = "premultiplied alpha"
    elif is_of_floats(image) and is_encoded(image):
        words = "alpha of floats with colour space %s" % image.colorspace_settings.name
    elif image.file_format in ("TIFF", "BMP", "WEBP") and not image.packed_file:
        # Of a TIFF Blender does not tell whether colours are times it; of a BMP Cycles reads none; of WebP it rounds them.
        words = "alpha of a %s" % image.file_format
    else:
        return ""
    return words if (pixels_of(image)[..., 3] < 1).any() else ""


def is_data(image):
    return image.colorspace_settings.name in DATA


def has_opacity(image):
    """Whether colours of an image may be times their opacity somewhere."""
    return image.depth in (32, 128) and image.alpha_mode not in ("CHANNEL_PACKED", "NONE") and not is_data(image)


def stored_texels(image, is_alone):
    """RGBA, rows from the top, as Cycles filters them: encoded if is_encoded(image)."""
    texels = pixels_of(image)
    if image.alpha_mode == "NONE":
        # Of an image of floats Blender has these linear.
        colour = encode_srgb(texels[..., :3]) if image.is_float and is_encoded(image) else texels[..., :3]
        return numpy.dstack((colour, numpy.ones(texels.shape[:2], numpy.float32)))
    alpha = texels[..., 3:]
    if image.is_float:
        # Blender has these linear, and times their opacity.
        mixed = has_opacity(image) and bool((alpha < 1).any())
        colour = straight_colour(image, texels, is_alone) if mixed else texels[..., :3]
        if is_encoded(image):
            colour = encode_srgb(colour)
            if mixed and is_alone and is_of_integers(image):
                colour = colour * alpha
        return numpy.dstack((colour, texels[..., 3]))
    if is_alone and has_opacity(image):
        return numpy.dstack((numpy.floor(texels[..., :3] * alpha * 255 + 0.001) / 255, texels[..., 3]))
    return texels


def is_of_floats(image):
    return image.file_format in OF_FLOATS


def is_of_integers(image):
    return image.source == "FILE" and not image.packed_file and not is_of_floats(image)


def straight_colour(image, texels, is_alone):
    """Linear colour of an image of floats; without its opacity, unless it is looked up alone."""
    alpha = texels[..., 3:]
    colour = texels[..., :3]
    straight = numpy.divide(colour, alpha, out=numpy.zeros_like(colour), where=alpha > 0)
    from_file = image.source == "FILE" and not image.packed_file and not image.is_dirty
    if from_file and image.alpha_mode == "STRAIGHT" and not is_of_integers(image):
        # Cycles takes what the file has for colours times their opacity, whatever the image says.
        colour = straight
        straight = numpy.divide(colour, alpha, out=numpy.zeros_like(colour), where=alpha > 0)
    if not is_alone or (is_encoded(image) and is_of_integers(image)):
        return straight
    return colour


def linear(texels, encoded):
    return numpy.dstack((decode_srgb(texels[..., :3]), texels[..., 3])) if encoded else texels


def linear_texels(image):
    """RGBA, rows from the top, without its encoding, as a shader sees it that asks for no Alpha."""
    return linear(stored_texels(image, True), is_encoded(image)).astype(numpy.float32)


def filter_gap(stored):
    """By what share of the mean a filter of decoded texels is off from one of encoded ones."""
    height, width = stored.shape[:2]
    if min(height, width) < 2:
        return 0
    rows, columns = (numpy.unique(numpy.linspace(0, n - 2, min(n - 1, SAMPLED)).astype(int)) for n in (height, width))

    def corner(down, right):
        return stored[rows + down][:, columns + right, :3].astype(float)

    a, b, c, d = (corner(down, right) for down in (0, 1) for right in (0, 1))
    near, far = 0.5 - 3 ** -0.5 / 2, 0.5 + 3 ** -0.5 / 2  # Gauss' places
    found = sum(decode_srgb((a * (1 - x) + b * x) * (1 - y) + (c * (1 - x) + d * x) * y).sum()
                for x in (near, far) for y in (near, far)) / 4
    wanted = sum(decode_srgb(texels).sum() for texels in (a, b, c, d)) / 4
    return abs(wanted / found - 1) if found > 0 else 0


def opacity_gap(stored):
    """By what share of the mean colours times opacity are off between texels where both are filtered, each by itself."""
    colour, alpha = stored[..., :3].astype(float), stored[..., 3:].astype(float)
    apart = sum(numpy.abs(numpy.diff(colour, axis=axis) * numpy.diff(alpha, axis=axis)).sum() for axis in (0, 1)) / 8
    shown = (colour * alpha).sum()
    return apart / shown if shown > 0 else 0


def weights_of(fraction, interpolation):
    """Of the neighbours, from one to the left on: of texels for linear filters, of cubic B-splines."""
    f = fraction
    if interpolation == "Linear":
        return numpy.stack((0 * f, 1 - f, f, 0 * f))
    return numpy.stack(((1 - f) ** 3, 4 - 6 * f ** 2 + 3 * f ** 3, 1 + 3 * f + 3 * f ** 2 - 3 * f ** 3, f ** 3)) / 6


def finer_along(stored, times, axis, interpolation, wraps):
    """The filter's value at `times` places for each texel along an axis."""
    count = stored.shape[axis]
    places = (numpy.arange(count * times) + 0.5) / times - 0.5
    first = numpy.floor(places).astype(int)
    shape = [1] * stored.ndim
    shape[axis] = -1
    result = 0
    for k, weight in enumerate(weights_of(places - first, interpolation)):
        index = first - 1 + k
        index = index % count if wraps else numpy.clip(index, 0, count - 1)
        result = result + numpy.take(stored, index, axis=axis) * weight.reshape(shape).astype(numpy.float32)
    return result


def finer(stored, encoded, interpolation):
    """How many times finer an image is to be along its sides, and what it does not show then; empty if it shows all."""
    if interpolation == "Closest":
        return 1, ""
    most = max(int((MOST_TEXELS / (stored.shape[0] * stored.shape[1])) ** 0.5), 1)
    gap = filter_gap(stored) if encoded else 0
    wanted = int(numpy.ceil((gap / LEAST_APART) ** 0.5)) if gap > MOST_APART else 1
    if interpolation != "Linear":
        if most == 1:
            return 1, "%s interpolation; here it is linear" % interpolation.lower()
        wanted = max(wanted, CUBIC_FINER)
    times = min(wanted, most)
    if gap / times ** 2 > 0.01:
        return times, "Cycles interpolates its texels encoded, darker by %.0f %%" % (100 * gap / times ** 2)
    return times, ""


def border_of(lookup):
    """Texels that are put around an image whose filter goes on where the image ends: of nothing where it is clipped, and
    of its last ones where these extend."""
    is_cubic = lookup.interpolation not in ("Linear", "Closest")
    return {"CLIP": 2 if is_cubic else 1, "EXTEND": int(is_cubic)}.get(lookup.extension, 0)


def border_matrix(image, lookup):
    """Of coordinates of an image to those of its texels with their border."""
    border = border_of(lookup)
    (width, height), (x, y) = (max(n, 1) for n in image.size), (max(n, 1) + 2 * border for n in image.size)
    return ((width / x, 0, 0, border / x), (0, height / y, 0, border / y), (0, 0, 1, 0), (0, 0, 0, 1))


class Texels:
    """RGBA of an image as an image node shows it, between texels, too, for a renderer that filters decoded ones."""

    def __init__(self, image, lookup):
        self.image = image
        self.lookup = lookup
        self.encoded = is_encoded(image)
        self.border = border_of(lookup)
        self.times, self.unknown = 1, ""
        if self.encoded or lookup.interpolation not in ("Linear", "Closest"):
            self.times, self.unknown = finer(self.stored, self.encoded, lookup.interpolation)
        if not lookup.is_alone and lookup.interpolation != "Closest" and has_opacity(image) and \
                opacity_gap(self.stored) > MOST_APART:
            self.unknown = self.unknown or "Cycles filters its colours times their opacity"

    @cached_property
    def stored(self):
        """As Cycles filters them, with their border."""
        found = stored_texels(self.image, self.lookup.is_alone)
        if not self.border:
            return found
        kind = "edge" if self.lookup.extension == "EXTEND" else "constant"
        return numpy.pad(found, ((self.border,) * 2, (self.border,) * 2, (0, 0)), kind)

    def is_own(self):
        """Whether the image's file has them."""
        image = self.image
        if self.border or self.times > 1 or image.alpha_mode == "NONE":
            return False
        return not (self.lookup.is_alone and has_opacity(image) and bool((self.stored[..., 3] < 1).any()))

    def linear(self):
        found = self.stored
        if self.times > 1:
            kind = "Linear" if self.lookup.interpolation == "Linear" else "Cubic"
            for axis in (0, 1):
                found = finer_along(found, self.times, axis, kind, self.lookup.extension == "REPEAT")
        return linear(found, self.encoded)
