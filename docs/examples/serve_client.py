"""Turns the sky and moves the camera of a set that shadowcache-render holds, and writes the last picture.

Usage: serve_client.py SET CACHE MAP PICTURE.ppm [--size WxH] [--options JSON] [--program shadowcache-render]

Prints the seconds to each picture: after load, of a camera that moves, of a sky that turns. Needs Python alone.
"""

import argparse
import array
import json
import math
import mmap
import os
import struct
import subprocess
import sys
import tempfile
import time

HEADER = struct.Struct("<8sQ9IxxxxQ")  # see docs/serve.md


class Server:
    """A process that renders; every call waits for its end."""

    def __init__(self, program):
        self.process = subprocess.Popen([program, "--serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.last = 0

    def ask(self, request, **fields):
        self.last += 1
        self.process.stdin.write(json.dumps({"id": self.last, "request": request, **fields}) + "\n")
        self.process.stdin.flush()
        for line in self.process.stdout:
            reply = json.loads(line)
            if reply["reply"] in ("log", "error"):
                print(reply.get("text") or reply["error"], file=sys.stderr)
            if reply["reply"] in ("done", "error", "stopped") and reply["id"] == self.last:
                if reply["reply"] != "done":
                    raise RuntimeError("%s: %s" % (request, reply["reply"]))
                return reply
        raise RuntimeError("the program has ended with status %s" % self.process.wait())

    def close(self):
        self.ask("quit")
        self.process.stdin.close()
        self.process.wait()


def read_picture(path):
    """The header's fields and the planes of floats, of a picture that is whole."""
    with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as memory:
        while True:
            fields = HEADER.unpack_from(memory)
            sequence, start, planes, width, height = fields[1], fields[3], fields[4], fields[5], fields[6]
            floats = array.array("f", memory[start:start + 4 * planes * width * height])
            if sequence % 2 == 0 and HEADER.unpack_from(memory)[1] == sequence:
                size = width * height
                return width, height, [floats[k * size:(k + 1) * size] for k in range(planes)]


def write_ppm(path, width, height, planes):
    """The first three planes as sRGB."""
    def code(value):
        value = min(max(value, 0.0), 1.0)
        return round(255 * (12.92 * value if value < 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055))
    with open(path, "wb") as out:
        out.write(b"P6 %d %d 255\n" % (width, height))
        out.write(bytes(code(value) for pixel in zip(*planes[:3]) for value in pixel))


def view(angle):
    """A camera on a circle."""
    turn = math.radians(angle)
    return {"origin": [6 * math.sin(turn), 3, 6 * math.cos(turn)], "up": [0, 1, 0],
            "forward": [-math.sin(turn), -0.35, -math.cos(turn)], "yfov": 0.9}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], allow_abbrev=False)
    for name in ("set", "cache", "map", "picture"):
        parser.add_argument(name)
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--options", default='{"samples": 0}', help="of the request options, as JSON")
    parser.add_argument("--program", default="shadowcache-render")
    arguments = parser.parse_args()
    width, height = map(int, arguments.size.split("x"))
    folder = tempfile.TemporaryDirectory(dir="/dev/shm" if os.path.isdir("/dev/shm") else None)
    pixels = os.path.join(folder.name, "pixels")

    server = Server(arguments.program)

    def picture(what, *requests):
        start = time.monotonic()
        for request, fields in requests:
            server.ask(request, **fields)
        server.ask("render", pixels=pixels)
        result = read_picture(pixels)
        print("%s: %.3f s" % (what, time.monotonic() - start))
        return result

    server.ask("options", **json.loads(arguments.options))
    server.ask("size", width=width, height=height)
    result = picture("load", ("load", {"set": [arguments.set], "cache": arguments.cache}),
                     ("environment", {"map": arguments.map}), ("camera", {"view": view(0)}))
    for angle in (10, 20, 30):
        result = picture("camera", ("camera", {"view": view(angle)}))
    for angle in (10, 20, 30):
        result = picture("sky", ("environment", {"map": arguments.map, "rotate": angle}))
    server.close()
    write_ppm(arguments.picture, *result)


main()
