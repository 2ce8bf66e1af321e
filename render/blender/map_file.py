# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether shadowcache-render reads the file of a world's image as Cycles does: where its header has nothing but what is known to
be read alike, and its texels are numbers.

Cycles ignores what a Radiance file says of its exposure and of where its rows begin, and the display window of an EXR.
"""

import mmap
import re
import struct

import numpy

from .blender_export.texels import pixels_of
from .session import stamp

HDR_NOTES = {"SOFTWARE", "CAPDATE", "GMT", "OWNER", "VIEW"}   # that change no texel
HDR_NEUTRAL = {"EXPOSURE": (1,), "GAMMA": (1,), "COLORCORR": (1, 1, 1), "PIXASPECT": (1,)}
HALF, FLOAT = 1, 2
EXR_MAGIC = b"\x76\x2f\x31\x01\x02"  # with the version
EXR_FLAGS = 0x06  # of one flat part: tiles, long names
LATLONG = 0
KNOWN = {}  # by path and stamp


def is_read_alike(image, path):
    """Of an image that Cycles reads from a file that ends with .exr or .hdr. Raises ValueError for a damaged header."""
    key = path, stamp(path)
    if key not in KNOWN:
        KNOWN[key] = is_plain_exr(image, path) if path.lower().endswith(".exr") else is_plain_hdr(path)
    return KNOWN[key]


def opened(path, read):
    """What read(bytes) finds in a file."""
    try:
        with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            return read(data)
    except (ValueError, IndexError, struct.error):
        raise ValueError("%s: its header is damaged" % path) from None


def is_plain_hdr(path):
    def read(data):
        if data[:2] != b"#?":
            raise ValueError
        end = re.compile(rb"\n\r?\n").search(data)
        lines = data[:end.start()].decode("latin-1").splitlines() if end else []
        size = re.compile(rb"-Y (\d+) \+X (\d+)\r?\n").match(data, end.end()) if end else None
        if not size or "FORMAT=32-bit_rle_rgbe" not in lines or not all(is_neutral(line) for line in lines[1:]):
            return False
        height, width = (int(number) for number in size.groups())
        # Of rows that repeat texels in the old way Cycles makes noise.
        is_flat = len(data) - size.end() == 4 * width * height
        return is_flat or data[size.end():size.end() + 2] == b"\2\2"

    return opened(path, read)


def is_neutral(line):
    """Whether a line of a Radiance header changes nothing: notes, and factors of 1."""
    name, is_value, value = line.partition("=")
    if not is_value or line.startswith("#") or not re.fullmatch(r"\w+", name):
        return True  # a comment, or the command of a program
    if name == "FORMAT":
        return value == "32-bit_rle_rgbe"
    try:
        return name in HDR_NOTES or tuple(float(word) for word in value.split()) == HDR_NEUTRAL[name]
    except (KeyError, ValueError):
        return False


def is_plain_exr(image, path):
    depths = opened(path, depths_of_plain)
    return bool(depths) and is_of_numbers(image, depths)


def depths_of_plain(data):
    """The kinds of numbers of the channels of an EXR in one flat part, whose data window is its display window; None of another."""
    if data[:5] != EXR_MAGIC:
        raise ValueError
    if data[5] & ~EXR_FLAGS or data[6] or data[7]:
        return None
    attributes = attributes_of(data)
    channels = list(channels_of(attributes["channels"]))
    names = {name for name, *_ in channels}
    depths = {kind for _, kind, *_ in channels}
    is_known = (names in ({"R", "G", "B"}, {"R", "G", "B", "A"}, {"Y"}) and depths in ({HALF}, {FLOAT})
                and all(sampling == (1, 1) for _, _, sampling in channels)
                and attributes["dataWindow"] == attributes["displayWindow"]
                and attributes.get("envmap", bytes((LATLONG,))) == bytes((LATLONG,)))
    return depths if is_known else None


def attributes_of(data):
    """Of the first header of an EXR: bytes by name."""
    at, found = 8, {}
    while data[at]:
        end = data.find(b"\0", at)
        kind = data.find(b"\0", end + 1)
        size, = struct.unpack_from("<i", data, kind + 1)
        if min(end, kind, size) < 0 or kind + 5 + size >= len(data):
            raise ValueError
        found[data[at:end].decode("latin-1")] = data[kind + 5:kind + 5 + size]
        at = kind + 5 + size
    if not {"channels", "dataWindow", "displayWindow"} <= set(found):
        raise ValueError
    return found


def channels_of(data):
    """Name, kind of number, and sampling of each channel."""
    while data[0]:
        name, _, data = data.partition(b"\0")
        kind, _, across, down = struct.unpack_from("<4i", data)
        yield name.decode("latin-1"), kind, (across, down)
        data = data[16:]


def is_of_numbers(image, depths):
    """Whether all texels are finite, or infinite halves, which Cycles takes for 65536."""
    texels = pixels_of(image)
    return bool((~numpy.isnan(texels)).all() if depths == {HALF} else numpy.isfinite(texels).all())
