# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes linear texels as an EXR of three float channels, uncompressed."""

import os
import struct

import numpy


def attribute(name, kind, data):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data


def write(path, texels):
    """texels: (height, width, 3 or more), rows from the top."""
    height, width = texels.shape[:2]
    channels = b"".join(name + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = (struct.pack("<ii", 20000630, 2) + attribute("channels", "chlist", channels)
              + attribute("compression", "compression", b"\0") + attribute("dataWindow", "box2i", window)
              + attribute("displayWindow", "box2i", window) + attribute("lineOrder", "lineOrder", b"\0")
              + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
              + attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
              + attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0")
    lines = numpy.empty(height, [("y", "<i4"), ("size", "<i4"), ("texels", "<f4", (3, width))])
    lines["y"], lines["size"] = numpy.arange(height), 12 * width
    lines["texels"] = texels[:, :, 2::-1].transpose(0, 2, 1)
    first = len(header) + 8 * height
    offsets = first + lines.itemsize * numpy.arange(height, dtype="<u8")
    with open(path + ".part", "wb") as out:
        out.write(header)
        out.write(offsets.astype("<u8"))
        out.write(lines)
    os.replace(path + ".part", path)
