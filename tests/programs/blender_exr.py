"""Reads EXR files of float scan lines without compression, as Blender's, with numpy alone."""

import struct

import numpy


def read(path):
    """Planes by channel name, rows from the top."""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:4] == b"\x76\x2f\x31\x01", path
    at, attributes = 8, {}
    while data[at]:
        end = data.index(b"\0", at)
        kind = data.index(b"\0", end + 1)
        size, = struct.unpack_from("<i", data, kind + 1)
        attributes[data[at:end].decode()] = data[kind + 5:kind + 5 + size]
        at = kind + 5 + size
    assert attributes["compression"] == b"\0", "%s: compressed" % path
    names, channels = [], attributes["channels"]
    while channels[0]:
        name, _, channels = channels.partition(b"\0")
        assert struct.unpack_from("<i", channels)[0] == 2, "%s: %s is no float" % (path, name)
        names.append(name.decode())
        channels = channels[16:]
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    line = numpy.dtype([("y", "<i4"), ("size", "<i4"), ("texels", "<f4", (len(names), width))])
    lines = numpy.frombuffer(data, line, height, at + 1 + 8 * height)
    assert (lines["y"] == numpy.arange(y0, y1 + 1)).all(), "%s: lines in another order" % path
    return {name: lines["texels"][:, i] for i, name in enumerate(names)}
