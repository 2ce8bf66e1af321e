"""Bakes and renders a shot, and measures errors, seconds and bytes."""
import os
import resource
import subprocess
import time
from dataclasses import dataclass, field
from typing import List, Optional, Tuple

import shadowcache

from .cycles import Rival, rival_of
from .ladder import Choice, Error, Frame, Point, choose, combine, ladder, price
from .pictures import agreement, noise_of_mean, relative_error
from .progress import Progress

# Camera rays of a pixel and samples of each, at which `mis` and the default cache are compared. The first is that of
# the ladder.
SPLITS = ((16, 4), (4, 1), (16, 1), (64, 1))
# Seeds of the two renders that make the reference; those of what is measured begin at 1.
REFERENCE_SEEDS = (1001, 1002)


@dataclass
class Shot:
    """What is measured."""
    files: List[str]
    environment: str
    camera_options: List[str]  # of shadowcache-bake and shadowcache-render
    set_options: List[str]
    bake_program: str
    scene: shadowcache.Scene
    sky: shadowcache.Environment
    camera: shadowcache.Camera
    frame: int  # that is rendered
    frames: int  # that are delivered
    size: Tuple[int, int]
    delivered: Tuple[int, int]
    seeds: int
    reference_rays: int
    whole_set: bool
    work: str  # folder of the caches
    bounces: int = 0
    albedo: float = 0.5
    choices: List[Choice] = field(default_factory=list)
    threads: int = 1
    up: str = "y"
    scale: float = 1.0
    cycles: Optional[str] = None  # Blender, None: left out

    @property
    def pixels(self):
        return self.delivered[0] * self.delivered[1] / (self.size[0] * self.size[1])


@dataclass
class Result:
    points: List[Point]
    best: Point
    cache: List[Tuple[Tuple[int, int], Frame]]  # by split, with the default cache
    mis: List[Tuple[Tuple[int, int], Frame]]
    reference_noise: float
    difference: Tuple[float, float]
    rival: Optional[Rival] = None


class Meter:
    """Measures a shot, step by step."""

    def __init__(self, shot, out=None):
        self.shot = shot
        choices = shot.choices or ladder([], [], [])
        self.choices = choices
        ladder_render = ("cache", self.work(SPLITS[0]) * shot.seeds)
        steps = [("bake", 1.0)] + [("reference", 1.0)] * 2
        for kind in ("mis", "cache"):
            steps += [(kind, self.work(split) * shot.seeds) for split in SPLITS]
        if shot.cycles:
            steps += [("Cycles", 1.0)]
        for choice in choices[1:]:
            steps += [("bake", choice.work()), ladder_render]
        self.progress = Progress(steps, out)

    @staticmethod
    def work(split):
        return split[0] * (1 + 0.5 * split[1])

    def bake(self, choice, spacing) -> Tuple[shadowcache.Cache, float, int]:
        """The cache, processor seconds over the threads, and bytes. Spacing in metres; None: chosen by the bake."""
        path = os.path.join(self.shot.work, "trade.vdb")
        command = [self.shot.bake_program, *self.shot.files, *self.shot.set_options, "-o", path, "--level",
                   str(choice.level), "--rays", str(choice.rays), "--threads", str(self.shot.threads), "--progress",
                   "none"]
        if spacing:
            command += ["--spacing", repr(spacing)]
        if not self.shot.whole_set:
            command += [*self.shot.camera_options, "--size", f"{self.shot.delivered[0]}x{self.shot.delivered[1]}"]
        seconds = self.progress.run(f"bake, {choice.name}", lambda _: run(command)) / self.shot.threads
        return shadowcache.Cache.open(path), seconds, os.path.getsize(path)

    def picture(self, cache, split, seed, report=None):
        """A picture, and its processor seconds over the threads."""
        shot = self.shot
        begin = time.process_time()
        color = shadowcache.render(shot.scene, cache, shot.sky, shot.camera, size=shot.size, camera_rays=split[0],
                                   samples=split[1], bounces=shot.bounces, seed=seed, frame=shot.frame,
                                   albedo=shot.albedo, estimator="cache" if cache else "mis",
                                   progress=report)["color"]
        return color, (time.process_time() - begin) / shot.threads

    def pictures(self, label, cache, split):
        def action(report):
            return [self.picture(cache, split, seed, report) for seed in range(1, self.shot.seeds + 1)]
        return self.progress.run(label, action)

    def frame_of(self, pictures, reference):
        errors = [relative_error(color, reference) for color, _ in pictures]
        return Frame(Error.of([e[0] for e in errors]), Error.of([e[1] for e in errors]),
                     min(seconds for _, seconds in pictures))

    def point(self, choice, baked, frame, reference):
        cache, seconds, size = baked
        preview = relative_error(self.picture(cache, (SPLITS[0][0], 0), 1)[0], reference)[0]
        return Point(choice, cache.spacing, seconds, size, frame, preview)

    def reference(self, cache):
        """Mean of two renders, and the relMSE that it has left."""
        split = (self.shot.reference_rays // 2, 4)
        first, second = (self.progress.run("reference", lambda report, seed=seed: self.picture(
            cache, split, seed, report)[0]) for seed in REFERENCE_SEEDS)
        return (first + second) / 2, noise_of_mean(first, second)

    def by_split(self, kind, cache, reference):
        """Frames by split, and all their pictures."""
        frames, pictures = [], []
        for split in SPLITS:
            found = self.pictures(f"{kind}, {split[0]} camera rays x {split[1]}", cache, split)
            frames.append((split, self.frame_of(found, reference)))
            pictures += [color for color, _ in found]
        return frames, pictures

    def run(self) -> Result:
        first = self.bake(self.choices[0], None)
        reference, noise = self.reference(first[0])
        mis, pictures = self.by_split("mis", None, reference)
        difference = agreement(pictures, reference)
        cache, _ = self.by_split("cache", first[0], reference)
        rival = self.progress.run("Cycles", lambda _: rival_of(self.shot, reference)) if self.shot.cycles else None
        points = [self.point(self.choices[0], first, cache[0][1], reference)]
        usual = points[0].spacing
        for choice in self.choices[1:]:
            points.append(self.measure(choice, usual, reference))
        price(points, self.shot.frames, self.shot.pixels)
        last: Optional[Choice] = combine(points)
        if last:
            self.progress.add([("bake", last.work()), ("cache", self.work(SPLITS[0]) * self.shot.seeds)])
            points.append(self.measure(last, usual, reference))
            price(points, self.shot.frames, self.shot.pixels)
        return Result(points, choose(points), cache, mis, noise, difference, rival)

    def measure(self, choice, usual, reference):
        baked = self.bake(choice, usual * choice.spacing)
        found = self.pictures(f"render, {choice.name}", baked[0], SPLITS[0])
        return self.point(choice, baked, self.frame_of(found, reference), reference)


def run(command):
    """Runs a program, and returns its processor seconds. Raises RuntimeError with what it wrote."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip() or f"{command[0]} ended with status {done.returncode}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
