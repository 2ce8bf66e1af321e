"""Pictures of a glTF document from Blender's images: as they are stored where their channels fit, else made new."""

import os
import struct
import zlib

import numpy

from .image_files import path_of
from .texels import Lookup, Texels, encode_srgb, has_texels, is_encoded, unknown_of

ONE = "one"  # a channel that is 1 everywhere; None is one that nothing reads
MIME = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg"}


def write_png(pixels, most):
    """Rows from the top of RGB or RGBA in [0, 1]; `most` is 255, or 65535 for 16 bits a channel."""
    height, width, channels = pixels.shape
    numbers = (numpy.clip(pixels, 0, 1) * most + 0.5).astype("u1" if most == 255 else ">u2")
    rows = numpy.zeros((height, 1 + width * channels * numbers.itemsize), numpy.uint8)
    rows[:, 1:] = numpy.frombuffer(numbers.tobytes(), numpy.uint8).reshape(height, -1)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", width, height, 8 if most == 255 else 16, 6 if channels == 4 else 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1)) +
            chunk(b"IEND", b""))


def stored_bytes(image):
    """The file of an image, packed or on disk, if it is a PNG or a JPEG that is not changed; else None."""
    if image.is_dirty or image.source != "FILE":
        return None
    if image.packed_file:
        data = image.packed_file.data
    else:
        path = path_of(image)
        if not os.path.isfile(path):
            return None
        with open(path, "rb") as file:
            data = file.read()
    return data if any(data.startswith(magic) for magic in MIME) else None


class Pictures:
    """Writes each picture once. A picture is four channels, each (node, channel) of an image node, ONE, or None if not
    read; a channel is a number, or weights of the three colours."""

    def __init__(self, file, report):
        self.file = file
        self.report = report
        self.known = {}

    def write(self, channels, colour, change=None):
        """The number of a picture, sRGB-encoded if `colour`; None if an image of it has no texels.

        change: (name, function) that makes other texels of linear ones."""
        key = tuple((Lookup.of(c[0]), c[1]) if isinstance(c, tuple) else c for c in channels) + (colour, change and change[0])
        if key not in self.known:
            self.known[key] = self._make(channels, colour, change)
        return self.known[key]

    def _make(self, channels, colour, change):
        nodes = {Lookup.of(c[0]): c[0] for c in channels if isinstance(c, tuple)}
        if not all(self._readable(node.image) for node in nodes.values()):
            return None
        node = next(iter(nodes.values()))
        in_place = len(nodes) == 1 and all(c is None or c == (node, i) for i, c in enumerate(channels)) and not change
        found = {lookup: Texels(node.image, lookup) for lookup, node in nodes.items()}
        for lookup, texels in found.items():
            if texels.unknown:
                self.report.add("image %s: %s" % (lookup.name, texels.unknown))
        own = in_place and all(t.is_own() and t.encoded == colour for t in found.values())
        data = (stored_bytes(node.image) if own else None) or self._compose(channels, colour, found, change)
        mime = next(kind for magic, kind in MIME.items() if data.startswith(magic))
        return self.file.add("images", {"name": node.image.name, "mimeType": mime, "bufferView": self.file.add_view(data)})

    def _readable(self, image):
        if image.source not in ("FILE", "GENERATED"):
            self.report.add("image %s: %s" % (image.name, image.source.lower()))
            return False
        if not has_texels(image):
            self.report.add("image %s: it has no texels" % image.name)
            return False
        unknown = unknown_of(image)
        if unknown:
            self.report.add("image %s: %s" % (image.name, unknown))
        if image.is_dirty and image.source == "FILE" and not image.packed_file:
            self.report.add("image %s: its changes are not saved; Cycles shows its file" % image.name)
        return True

    def _compose(self, channels, colour, found, change):
        texels = {lookup: t.linear() for lookup, t in found.items()}
        height, width = max(rgba.shape[:2] for rgba in texels.values())
        if len({(*rgba.shape[:2], lookup.interpolation) for lookup, rgba in texels.items()}) > 1:
            for name in sorted({lookup.name for lookup in texels}):
                self.report.add("image %s: in one texture with others of another size or filter" % name)
        if len({lookup.name for lookup in texels}) < len(texels):
            self.report.add("image %s: looked up with Alpha and without" % next(iter(texels)).name)
        texels = {lookup: self._sized(rgba, height, width) for lookup, rgba in texels.items()}

        def plane(channel):
            if not isinstance(channel, tuple):
                return numpy.ones((height, width), numpy.float32)
            rgba, number = texels[Lookup.of(channel[0])], channel[1]
            return rgba[..., :3] @ numpy.array(number, numpy.float32) if isinstance(number, tuple) else rgba[..., number]

        pixels = numpy.dstack([plane(c) for c in channels[: 3 if not isinstance(channels[3], tuple) else 4]])
        if change:
            pixels = change[1](pixels)
        images = {c[0].image for c in channels if isinstance(c, tuple)}
        if pixels.max() > 1:
            self.report.add("image %s: values above 1" % next(iter(images)).name)
        if colour:
            pixels[..., :3] = encode_srgb(pixels[..., :3])
        plain = not change and all(not i.is_float and is_encoded(i) == colour for i in images)
        return write_png(pixels, 255 if plain else 65535)

    @staticmethod
    def _sized(rgba, height, width):
        """The nearest texels, for pictures of several sizes in one."""
        if rgba.shape[:2] == (height, width):
            return rgba
        rows = numpy.arange(height) * rgba.shape[0] // height
        columns = numpy.arange(width) * rgba.shape[1] // width
        return rgba[rows][:, columns]
