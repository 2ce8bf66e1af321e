# SPDX-License-Identifier: GPL-3.0-or-later
"""The cache of a set: whether it is there and of what, and how it is baked."""

import glob
import json
import os
import shutil
import tempfile

from . import child, programs
from .fingerprint import digest_of
from .set_file import fps

MARGIN = ("--margin", "1")  # voxels around those that a shot looks up


class Recipe:
    """What a bake is asked for, by the settings of a scene."""

    def __init__(self, settings):
        self.quality = settings.bake_quality.lower()
        self.spacing = settings.bake_spacing
        self.whole = settings.bake_scope == "SET"

    def options(self, prefix="--"):
        """Of shadowcache-bake; with "--bake-": of shadowcache-render, for a bake of its own."""
        name, value = ("spacing", "%.9g" % self.spacing) if self.spacing else ("quality", self.quality)
        return [prefix + name, value]


class Views:
    """The camera of each frame that a shot bake serves: {frame: keys of the request camera}."""

    def __init__(self, frames, size):
        self.frames = frames
        self.size = size

    def digests(self):
        return {digest_of(json.dumps(view, sort_keys=True)) for view in self.frames.values()}

    def write(self, path, rate):
        """A camera file; frames that are not asked for have the view of one that is."""
        entries, last = [], next(iter(self.frames.values()))
        for frame in range(1, max(self.frames) + 1):
            last = self.frames.get(frame, last)
            entries.append(last)
        with open(path, "w", encoding="ascii") as out:
            json.dump({"cam": {"fps": rate, "frames": entries}}, out)

    def serves(self):
        return min(self.frames) >= 1  # a camera file begins with frame 1


def why_bake(set_file, recipe, views):
    """Why a bake is needed, as a text; empty if the cache has all that is asked for, if it is of this set."""
    notes = set_file.read_notes().get("bake")
    if not notes or not os.path.exists(set_file.cache):
        return "there is no cache"
    if notes["options"] != recipe.options():
        return "the settings of the bake have changed"
    if not notes["whole"] and (recipe.whole or not views.digests() <= set(notes["views"])):
        return "the cache was baked for other frames"
    return ""


def bake(set_file, recipe, views, scene, folder, should_stop, on_progress):
    """Bakes what is missing. on_progress(task, share, seconds left)."""
    notes = set_file.read_notes()
    before = notes.get("bake") or {}
    extend = (os.path.exists(set_file.cache) and before.get("options") == recipe.options()
              and before.get("set") == notes["id"] and not before.get("whole"))
    whole = recipe.whole or not views.serves()
    # What is extended has its own spacing and level.
    options = ["--extend", set_file.cache] if extend else recipe.options()
    if not whole:
        options += [*shot_options(set_file, views, fps(scene)), *MARGIN]
    command = [programs.find("shadowcache-bake", folder), set_file.path, "-o", set_file.cache, *options,
               "--progress", "json"]
    try:
        child.run(command, should_stop, lambda process: on_progress(*progress_of(process)))
    finally:
        clean(set_file.cache)
    views_held = set(before["views"]) if extend else set()
    notes["bake"] = {"options": recipe.options(), "whole": whole, "set": notes["id"],
                     "views": sorted(views_held | views.digests())}
    set_file.write_notes(notes)


def estimate(set_file, recipe, views, rate, folder, should_stop):
    """What a bake of these views, or of the whole set, takes: the "estimate" of shadowcache-bake's statistics. views
    is None if Recipe.whole."""
    shot = [*shot_options(set_file, views, rate), *MARGIN] if views and views.serves() else []
    command = [programs.find("shadowcache-bake", folder), set_file.path, "--estimate", *recipe.options(), *shot]
    return stats_of(command, set_file, should_stop)["estimate"]


def worth(set_file, recipe, views, rate, options, folder, should_stop):
    """Seconds of a picture with a bake of these views and of one of the same noise without: "frame" and "frame_without".
    options: of light and picture, for shadowcache-render."""
    command = [programs.find("shadowcache-render", folder), set_file.path, "--bake", set_file.cache + ".none.vdb", "--explain",
               *recipe.options("--bake-"), "-o", "none.####.exr", *shot_options(set_file, views, rate), *options]
    return stats_of(command, set_file, should_stop)["worth"]["seconds"]


def stats_of(command, set_file, should_stop):
    """The statistics of a program that writes nothing else."""
    with tempfile.TemporaryDirectory() as work:
        stats = os.path.join(work, "stats.json")
        try:
            child.run([*command, "--stats", stats, "--progress", "none"], should_stop)
        finally:
            clean(set_file.cache)
        with open(stats, encoding="ascii") as file:
            return json.load(file)


def camera_of(set_file):
    return set_file.cache + ".camera.json"


def shot_options(set_file, views, rate):
    """That name these views to both programs; writes their camera file."""
    views.write(camera_of(set_file), rate)
    frames = ",".join(str(frame) for frame in sorted(views.frames))
    return ["--camera", camera_of(set_file), "--frames", frames, "--size", "%dx%d" % views.size,
            "--fps", "%.9g" % rate]


def progress_of(process):
    """Task, share that is done and seconds left, by the last line of a program's progress."""
    for line in reversed(process.last_lines()):
        if line.startswith("{"):
            try:
                found = json.loads(line)
                return found["task"], found["done"] / found["total"], found["left"]
            except (ValueError, KeyError):
                continue
    return "", 0, 0


def time_text(seconds):
    return "%d:%02d" % (seconds // 60, seconds % 60)


def clean(cache):
    """Removes what an unfinished bake leaves."""
    for path in glob.glob(glob.escape(cache) + ".part-*") + [cache + ".camera.json"]:
        if os.path.exists(path):
            os.remove(path)
    shutil.rmtree(cache + ".checkpoint", ignore_errors=True)


def forget(set_file):
    """Removes the cache."""
    notes = set_file.read_notes()
    if notes.pop("bake", None):
        set_file.write_notes(notes)
    if os.path.exists(set_file.cache):
        os.remove(set_file.cache)
    clean(set_file.cache)
