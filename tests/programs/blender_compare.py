"""Pictures of small scenes (blender_kit.py) beside those of Cycles: means of their parts, which a file of values keeps."""

import json
import os
import sys
import time

import blender_exr
import bpy
import numpy
from blender_kit import NAMED, SHOWN
from blender_scene import WORK

PARTS = (2, 3)
STORES = "SHADOWCACHE_STORE" in os.environ
ONLY = os.environ.get("SHADOWCACHE_ONLY", "").split()


def chosen(scenes):
    return [(name, found) for name, found in scenes.items() if not ONLY or name in ONLY]


def render(engine, channels):
    """Means of the picture's parts (part, channel), and what is named."""
    scene = bpy.context.scene
    scene.render.engine, scene.render.filepath = engine, os.path.join(WORK, "picture.exr")
    bpy.ops.render.render(write_still=True)
    found = {name.split(".", 1)[1]: plane for name, plane in blender_exr.read(scene.render.filepath).items()}
    stack = numpy.stack([found["Combined.%s" % c] for c in channels]).astype(float)
    (rows, columns), (height, width) = PARTS, stack.shape[1:]
    parts = stack.reshape(len(channels), rows, height // rows, columns, width // columns)
    return parts.mean(axis=(2, 4)).reshape(len(channels), -1).T, sys.modules["shadowcache.engine"].LEFT_OUT.get(scene.name, [])


def apart(found, wanted):
    """How far the means are apart, and the colours of the parts, as shares of the greatest mean of a colour."""
    found, wanted = found[:, :3], numpy.array(wanted)[:, :3]
    most = max(wanted.mean(axis=0).max(), 1e-3)
    return abs(found.mean(axis=0) - wanted.mean(axis=0)).max() / most, abs(found - wanted).max() / most


class Values:
    """Those of Cycles, by scene, in a file beside the tests. start(): makes what the scenes have in common."""

    def __init__(self, name, start, channels):
        self.path = os.path.join(os.path.dirname(os.path.abspath(__file__)), name)
        self.start = start
        self.channels = channels

    def read(self):
        with open(self.path, encoding="ascii") as file:
            return {name: numpy.array(rows) for name, rows in json.load(file).items()}

    def store(self):
        """Of the chosen scenes; the others keep theirs."""
        values = {name: rows.tolist() for name, rows in self.read().items() if name in SHOWN} if ONLY else {}
        for name, make in chosen(SHOWN):
            self.start()
            make()
            values[name] = render("CYCLES", self.channels)[0].round(5).tolist()
        with open(self.path, "w", encoding="ascii") as out:
            out.write("{\n%s\n}\n" % ",\n".join('"%s": %s' % (name, json.dumps(rows)) for name, rows in values.items()))

    def compare(self, most_mean, most_part, may_name=lambda scene, entry: False):
        """Renders all, each within shares of its mean. Returns the values."""
        values = self.read()
        assert set(values) == set(SHOWN), "store the values of Cycles again: %s" % sorted(set(values) ^ set(SHOWN))
        for name, make in chosen(SHOWN):
            self.start()
            make()
            found, left_out = render("SHADOWCACHE", self.channels)
            left_out = [entry for entry in left_out if not may_name(name, entry)]
            mean, part = apart(found, values[name])
            print("case %s: mean off by %.4f, a part by %.4f %s" % (name, mean, part, left_out))
            assert mean < most_mean and part < most_part, "%s: %s, expected %s" % (
                name, found.round(4).tolist(), values[name].tolist())
            assert not left_out, "%s: %s" % (name, left_out)
        return values


def names_all(start, left_out_of):
    """left_out_of(depsgraph, set_frame): what is named of a scene."""
    for name, (make, words) in chosen(NAMED):
        start()
        make()
        left_out = sys.modules["shadowcache.blender_export"].with_render_depsgraph(left_out_of)
        assert any(words in entry for entry in left_out), "%s: %s" % (name, left_out)


def run(store, cases):
    for case in (store,) if STORES else cases:
        before = time.monotonic()
        case()
        print("case %s: passed in %.1f s" % (case.__name__, time.monotonic() - before))
    print("all cases passed")
