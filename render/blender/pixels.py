# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the file of pixels that shadowcache-render --serve writes (docs/serve.md)."""

import mmap
import os
import secrets
import struct
import tempfile
import time

import numpy

HEADER = struct.Struct("<8sQ9IxxxxQ")
MAGIC, VERSION = b"SHCPIXEL", 1
MOST_SECONDS = 2.0  # that a writer may take


def new_path():
    """A name for such a file, in memory where the system has a folder for that."""
    folder = "/dev/shm" if os.path.isdir("/dev/shm") else tempfile.gettempdir()
    return os.path.join(folder, "shadowcache-%d-%s" % (os.getpid(), secrets.token_hex(8)))


def read(path):
    """Planes (n, height, width) of float32, rows from the top, of a picture that is whole. Raises OSError."""
    with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as memory:
        deadline = time.monotonic() + MOST_SECONDS
        while time.monotonic() < deadline:
            magic, sequence, version, start, planes, width, height, *_ = HEADER.unpack_from(memory)
            if magic != MAGIC or version != VERSION:
                raise OSError("%s: pixels of another layout, expected version %d" % (path, VERSION))
            count = planes * width * height
            if sequence % 2 == 0 and start + 4 * count <= len(memory):
                result = numpy.frombuffer(memory[start:start + 4 * count], "<f4").reshape(planes, height, width)
                if HEADER.unpack_from(memory)[1] == sequence:
                    return result
            time.sleep(0.001)
    raise OSError("%s: pixels that are never whole" % path)


def remove(path):
    if path and os.path.exists(path):
        os.remove(path)
