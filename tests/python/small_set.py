"""Sets that tests of the module share, and their caches by the programs; conftest.py has them as fixtures.

Needs SHADOWCACHE_BUILD, the folder of a build, and SHADOWCACHE_SOURCE, that of the sources.
"""
import functools
import json
import os
import subprocess
from pathlib import Path

import numpy as np

import shadowcache

BUILD = Path(os.environ["SHADOWCACHE_BUILD"])
SOURCE = Path(os.environ["SHADOWCACHE_SOURCE"])
MAP = SOURCE / "scenes/maps/sunrise.exr"
PROGRAMS = {"make-set": "scenes", "bake": "bake", "render": "render"}

# A floor of 4 m, and a roof over its half x < 0.
VERTICES = np.array([[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2],
                     [-2, 1, -2], [0, 1, -2], [0, 1, 2], [-2, 1, 2]], dtype=np.float64)
TRIANGLES = np.array([[0, 2, 1], [0, 3, 2], [4, 6, 5], [4, 7, 6]])
OPEN, COVERED = (1.5, 0, 0), (-1.5, 0, 0)
UP = (0, 1, 0)


def run(program, *arguments):
    """What a program prints."""
    command = [BUILD / PROGRAMS[program] / f"shadowcache-{program}", *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


class Baked:
    """Files of a set with materials, of a camera that moves, and of a cache by the program, made where it is asked for."""

    def __init__(self, file, spacing):
        self.folder, self.file, self.camera = file.parent, file, file.parent / "camera.json"
        self.options = {"spacing": spacing, "level": 2, "rays": 2}

    @functools.cached_property
    def cache(self):
        words = (word for name, value in self.options.items() for word in (f"--{name}", value))
        run("bake", self.file, "-o", self.folder / "set.vdb", *words)
        return self.folder / "set.vdb"

    @functools.cached_property
    def scene(self):
        return shadowcache.load_set(self.file)


def courtyard(folder):
    """The bundled set, with textures."""
    run("make-set", "courtyard", "-o", folder / "courtyard.glb", "--camera", folder / "camera.json")
    return Baked(folder / "courtyard.glb", 6)


def small(folder):
    """Floor and roof, and a camera that looks along the open half, away from the roof."""
    floor, roof = ([f"f {a} {b} {c}" for a, b, c in part + 1] for part in (TRIANGLES[:2], TRIANGLES[2:]))
    lines = ["mtllib set.mtl", *(f"v {x} {y} {z}" for x, y, z in VERTICES), "usemtl floor", *floor, "usemtl roof", *roof]
    (folder / "set.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "set.mtl").write_text("newmtl floor\nKd .6 .5 .4\nnewmtl roof\nKd .3 .5 .7\nPr .3\nPm .5\n", encoding="utf-8")
    frames = [{"origin": [0.3 + 0.02 * frame, 0.6, 0.01 * frame], "forward": [0.8, -0.6, 0], "up": [0.6, 0.8, 0]} for frame in range(12)]
    (folder / "camera.json").write_text(json.dumps({"cam": {"yfov": 0.9, "fps": 24, "frames": frames}}), encoding="utf-8")
    return Baked(folder / "set.obj", 0.5)
