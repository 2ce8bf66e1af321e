"""A camera move through the bundled courtyard with four bounces, in the morning: sheet.py BUILD WORK court|room SHEET.jpg

`court` is the move of shadowcache-make-set, `room` one through the furnished room. Bakes the shot, renders its 24 frames of 960 x
540 pixels with 8 camera rays of 4 shadow rays, and has Cycles render three of them with the samples that take as long. The middle
one is rendered with more seeds: prints seconds of the processor, the relMSE of a picture by the difference of two, relative to the
mean of six of ours, and the means. Writes all frames, and parts of the three as they are, ours above those of Cycles. Needs blender on
PATH, and NumPy, matplotlib and OpenImageIO of Debian's Python.
"""
import json
import os
import resource
import subprocess
import sys

import matplotlib.image
import numpy
import OpenImageIO

BENCHMARKS = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(BENCHMARKS))
IN_BLENDER = os.path.join(ROOT, "render/trade/shadowcache_trade/in_blender.py")
MAP, TURN = os.path.join(ROOT, "scenes/maps/sunrise.exr"), 120  # degrees
EXPOSURES = {"court": 1, "room": 4}  # stops
FRAMES, SHOWN = 24, (1, 12, 24)
WIDTH, HEIGHT = 960, 540
SEEDS = 6
BOUNCES, RAYS = 4, (8, 4)
PILOT = 8  # samples of Cycles, to find how long one takes
COLUMNS = 6
PART = (480, 270)


def room_track():
    """The camera steps back along the room and turns to the table."""
    frames = []
    for way in numpy.linspace(0, 1, FRAMES):
        origin = [-9.6 - 0.5 * way, 1.9 - 0.2 * way, -2.4 + 1.6 * way]
        frames.append({"origin": origin, "forward": [t - o for t, o in zip((-14, 1.2, 1.5), origin)], "up": [0, 1, 0]})
    return {"yfov": numpy.radians(60), "fps": 24, "frames": frames}


def seconds_of(command):
    """Of the processor, all threads."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def read(path):
    """Linear RGB, (height, width, 3)."""
    picture = OpenImageIO.ImageBuf(path)
    names = list(picture.spec().channelnames)
    pixels = picture.get_pixels(OpenImageIO.FLOAT)
    return pixels[..., [next(i for i, name in enumerate(names) if name.split(".")[-1] == c) for c in "RGB"]].astype(float)


def shown(pixels, exposure):
    """For the screen, 0 to 1: exposed, sRGB."""
    linear = numpy.clip(pixels * 2.0 ** exposure, 0, 1)
    return numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def noise(a, b, reference):
    """relMSE of one of two pictures of other seeds, and its 99th percentile."""
    error = ((a - b) ** 2 / 2 / (reference ** 2 + 0.01 * reference.mean() ** 2)).mean(-1)
    return error.mean(), numpy.percentile(error, 99)


class Sheet:
    def __init__(self, build, work, move):
        self.build, self.work, self.move = build, work, move
        os.makedirs(work, exist_ok=True)
        self.set, self.camera, self.cache = (os.path.join(work, name) for name in ("courtyard.glb", "move.json", "move.vdb"))

    def bake(self):
        subprocess.run([os.path.join(self.build, "scenes/shadowcache-make-set"), "courtyard", "-o", self.set,
                        "--camera", self.camera], check=True)
        if self.move == "room":
            with open(self.camera, "w", encoding="utf-8") as file:
                json.dump({"cam": room_track()}, file)
        return seconds_of([os.path.join(self.build, "bake/shadowcache-bake"), self.set, "-o", self.cache,
                           "--camera", self.camera, "--frames", "1-%d" % FRAMES, "--size", "%dx%d" % (WIDTH, HEIGHT)])

    def ours(self, seed, frames):
        """Renders frames; seconds of one, with what is done once for all of them."""
        command = [os.path.join(self.build, "render/shadowcache-render"), self.set, "--cache", self.cache, "--env", MAP,
                   "--env-rotate", str(TURN), "--camera", self.camera, "--frames", ",".join(map(str, frames)),
                   "--size", "%dx%d" % (WIDTH, HEIGHT), "--bounces", str(BOUNCES), "--camera-rays", str(RAYS[0]),
                   "--samples", str(RAYS[1]), "--seed", str(seed), "-o", self.our_path(seed, "####")]
        return seconds_of(command) / len(frames)

    def our_path(self, seed, frame):
        return os.path.join(self.work, "ours%d.%s.exr" % (seed, frame if isinstance(frame, str) else "%04d" % frame))

    def cycles(self, frame, renders):
        """Renders a frame, for (samples, seed) each; seconds of each."""
        with open(self.camera, encoding="utf-8") as file:
            track = json.load(file)["cam"]
        request = {"files": [self.set], "up": "y", "scale": 1, "albedo": 0.5, "map": MAP, "rotate": TURN,
                   "camera": {**track["frames"][frame - 1], "fov": numpy.degrees(track["yfov"])}, "size": [WIDTH, HEIGHT], "bounces": BOUNCES, "threads": os.cpu_count(),
                   "renders": [{"samples": samples, "seed": seed, "picture": self.cycles_path(seed, frame)}
                               for samples, seed in renders], "stats": os.path.join(self.work, "cycles.json")}
        name = os.path.join(self.work, "request.json")
        with open(name, "w", encoding="utf-8") as file:
            json.dump(request, file)
        subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "1", "--python-use-system-env",
                        "--python", IN_BLENDER, "--", name], check=True, stdout=subprocess.DEVNULL)
        with open(request["stats"], encoding="utf-8") as file:
            return json.load(file)["seconds"]

    def cycles_path(self, seed, frame):
        return os.path.join(self.work, "cycles%d.%04d.exr" % (seed, frame))

    def shown(self, pixels):
        return shown(pixels, EXPOSURES[self.move])

    def compose(self, path):
        small = (WIDTH * 3 // 2 // COLUMNS, HEIGHT * 3 // 2 // COLUMNS)
        step = WIDTH // small[0]
        frames = [self.shown(read(self.our_path(1, f)).reshape(small[1], step, small[0], step, 3).mean((1, 3)))
                  for f in range(1, FRAMES + 1)]
        rows = [numpy.concatenate(frames[i:i + COLUMNS], 1) for i in range(0, FRAMES, COLUMNS)]
        left, top = (WIDTH - PART[0]) // 2, (HEIGHT - PART[1]) // 2
        for path_of in (self.our_path, self.cycles_path):
            parts = [read(path_of(1, f))[top:top + PART[1], left:left + PART[0]] for f in SHOWN]
            rows.append(self.shown(numpy.concatenate(parts, 1)))
        matplotlib.image.imsave(path, (numpy.concatenate(rows) * 255).round().astype(numpy.uint8), pil_kwargs={"quality": 88})

    def compare(self, samples):
        """Noise and light of the middle frame."""
        frame = SHOWN[1]
        for seed in range(2, SEEDS + 1):
            self.ours(seed, [frame])
        seconds = min(self.cycles(frame, [(samples, 1), (samples, 2)]))
        ours = [read(self.our_path(seed, frame)) for seed in range(1, SEEDS + 1)]
        theirs = [read(self.cycles_path(seed, frame)) for seed in (1, 2)]
        reference = sum(ours) / SEEDS
        for name, pictures, light in (("Shadowcache", ours, reference), ("Cycles, %d samples, %.1f s" % (samples, seconds), theirs,
                                                                         sum(theirs) / 2)):
            print("%s: relMSE %.3g, p99 %.3g, mean %.4g" % (name, *noise(*pictures[:2], reference), light.mean()), flush=True)

    def run(self, path):
        print("bake: %.1f s" % self.bake(), flush=True)
        seconds = self.ours(1, range(1, FRAMES + 1))
        print("a frame: %.1f s" % seconds, flush=True)
        samples = max(1, round(PILOT * seconds / self.cycles(SHOWN[1], [(PILOT, 1)])[0]))
        for frame in SHOWN:
            self.cycles(frame, [(samples, 1)])
        self.compose(path)
        self.compare(samples)


if __name__ == "__main__":
    if len(sys.argv) != 5 or sys.argv[3] not in EXPOSURES:
        sys.exit(__doc__)
    Sheet(*sys.argv[1:4]).run(sys.argv[4])
