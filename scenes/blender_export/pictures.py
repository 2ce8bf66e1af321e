"""Pictures of a glTF document from Blender's images: as they are stored where their channels fit, else made new."""

import os
import struct
import zlib

import numpy
import bpy

ONE = "one"  # a channel that is 1 everywhere; None is one that nothing reads
SRGB = ("sRGB", "Filmic sRGB")
MIME = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg"}


def decode_srgb(x):
    return numpy.where(x <= 0.04045, x / 12.92, ((numpy.maximum(x, 0) + 0.055) / 1.055) ** 2.4)


def encode_srgb(x):
    return numpy.where(x <= 0.0031308, x * 12.92, 1.055 * numpy.maximum(x, 0) ** (1 / 2.4) - 0.055)


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
        path = bpy.path.abspath(image.filepath, library=image.library)
        if not os.path.isfile(path):
            return None
        with open(path, "rb") as file:
            data = file.read()
    return data if any(data.startswith(magic) for magic in MIME) else None


def linear_texels(image):
    """RGBA, rows from the top; colour without its encoding, as shaders see it."""
    width, height = image.size
    texels = numpy.empty(width * height * 4, numpy.float32)
    image.pixels.foreach_get(texels)
    texels = texels.reshape(height, width, 4)[::-1]
    if not image.is_float and image.colorspace_settings.name in SRGB:
        texels = numpy.dstack((decode_srgb(texels[..., :3]), texels[..., 3]))
    if image.alpha_mode == "NONE":
        texels = numpy.dstack((texels[..., :3], numpy.ones((height, width), numpy.float32)))
    return texels


class Pictures:
    """Writes each picture once. A picture is four channels, each (image, channel), ONE, or None if not read."""

    def __init__(self, file, report):
        self.file = file
        self.report = report
        self.known = {}

    def write(self, channels, colour):
        """The number of a picture, sRGB-encoded if `colour`; None if an image of it has no texels."""
        key = tuple((c[0].name_full, c[1]) if isinstance(c, tuple) else c for c in channels) + (colour,)
        if key not in self.known:
            self.known[key] = self._make(channels, colour)
        return self.known[key]

    def _make(self, channels, colour):
        images = {c[0].name_full: c[0] for c in channels if isinstance(c, tuple)}
        for name, image in images.items():
            if not self._readable(name, image):
                return None
        name, image = next(iter(images.items()))
        in_place = len(images) == 1 and all(c is None or c == (image, i) for i, c in enumerate(channels))
        encoded = image.colorspace_settings.name in SRGB
        data = stored_bytes(image) if in_place and encoded == colour and image.alpha_mode != "NONE" else None
        data = data or self._compose(name, channels, colour, images)
        mime = next(kind for magic, kind in MIME.items() if data.startswith(magic))
        return self.file.add("images", {"name": name, "mimeType": mime, "bufferView": self.file.add_view(data)})

    def _readable(self, name, image):
        if image.source not in ("FILE", "GENERATED"):
            self.report.add("image %s: %s" % (name, image.source.lower()))
            return False
        if not (image.has_data or len(image.pixels)) or 0 in tuple(image.size):
            self.report.add("image %s: it has no texels" % name)
            return False
        return True

    def _compose(self, name, channels, colour, images):
        height, width = max((image.size[1], image.size[0]) for image in images.values())
        texels = {key: self._sized(linear_texels(image), height, width) for key, image in images.items()}
        planes = [texels[c[0].name_full][..., c[1]] if isinstance(c, tuple) else
                  numpy.ones((height, width), numpy.float32) for c in channels]
        pixels = numpy.dstack(planes[: 3 if not isinstance(channels[3], tuple) else 4])
        if pixels.max() > 1:
            self.report.add("image %s: values above 1" % name)
        if colour:
            pixels[..., :3] = encode_srgb(pixels[..., :3])
        plain = all(not i.is_float and i.colorspace_settings.name not in SRGB for i in images.values())
        return write_png(pixels, 255 if colour or plain else 65535)

    @staticmethod
    def _sized(texels, height, width):
        """The nearest texels, for pictures of several sizes in one."""
        if texels.shape[:2] == (height, width):
            return texels
        rows = numpy.arange(height) * texels.shape[0] // height
        columns = numpy.arange(width) * texels.shape[1] // width
        return texels[rows][:, columns]
