"""Blender's Cycles as a rival: pictures of the same shot, and their errors against its own reference of many samples."""
import json
import os
import subprocess
from dataclasses import dataclass, field
from typing import List, Tuple

import numpy as np

import shadowcache

from .ladder import Error, Frame
from .pictures import relative_error

# Samples of a pixel of the pictures that are measured.
SAMPLES = (16, 64)
# Light of the two references that may differ, for materials and maps are not filtered alike.
MOST_DIFFERENCE = 0.01
REFERENCE_SEED = 1001
READ = (".gltf", ".glb", ".obj", ".ply", ".stl")


@dataclass
class Rival:
    """What was measured, or the reason why nothing was."""
    frames: List[Tuple[int, Frame]] = field(default_factory=list)  # by samples
    load_seconds: float = 0.0  # over the threads: from the start to a first picture of one sample
    difference: float = 0.0  # of all light, relative to our reference
    reason: str = ""


def obstacle(shot):
    """Why Cycles would not render the same picture; empty if it might."""
    extensions = {os.path.splitext(path)[1].lower() for path in shot.files}
    if not extensions <= set(READ):
        return f"Blender's importers read {', '.join(READ)}"
    if shot.up != "y" and extensions & {".gltf", ".glb"}:
        return "Blender's importer takes glTF for +Y up"
    if shot.camera.fov is None or shot.camera.lens_radius > 0:
        return "the camera has a lens, or no perspective"
    return ""


def request_of(shot, renders, folder):
    """What in_blender.py is asked for; renders: (samples, seed) of each."""
    camera = shot.camera
    return {"files": [os.path.abspath(path) for path in shot.files], "up": shot.up, "scale": shot.scale,
            "map": os.path.abspath(shot.environment), "rotate": shot.sky.rotation,
            "camera": {"origin": camera.origin.tolist(), "forward": camera.forward.tolist(), "up": camera.up.tolist(),
                       "fov": camera.fov},
            "size": shot.size, "albedo": shot.albedo, "bounces": shot.bounces, "threads": shot.threads,
            "renders": [{"samples": samples, "seed": seed, "picture": os.path.join(folder, f"cycles{i}.exr")}
                        for i, (samples, seed) in enumerate(renders)],
            "stats": os.path.join(folder, "cycles.json")}


def render(shot, renders):
    """(pictures, their processor seconds, those until the first) over the threads. Raises RuntimeError."""
    request = request_of(shot, renders, shot.work)
    path = os.path.join(shot.work, "request.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(request, file)
    script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "in_blender.py")
    # Debian's Blender takes NumPy from where the first python3 of PATH has it.
    environment = {**os.environ, "PATH": "/usr/bin:" + os.environ.get("PATH", "")}
    done = subprocess.run([shot.cycles, "-b", "--factory-startup", "--python-exit-code", "1", "--python", script, "--", path],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", env=environment,
                          check=False)
    if done.returncode != 0:
        said = [line.strip() for line in done.stdout.splitlines() if "Error" in line]
        raise RuntimeError(said[0] if said else f"{shot.cycles} ended with status {done.returncode}")
    with open(request["stats"], encoding="utf-8") as file:
        stats = json.load(file)
    pictures = [shadowcache.read_exr(wanted["picture"])["color"][..., :3] for wanted in request["renders"]]
    return pictures, [seconds / shot.threads for seconds in stats["seconds"]], stats["load_seconds"] / shot.threads


def rival_of(shot, reference):
    """Measures Cycles; where its light is not that of `reference`, only the reason is left."""
    reason = obstacle(shot)
    if reason:
        return Rival(reason=reason)
    seeds = range(1, shot.seeds + 1)
    renders = [(samples, seed) for samples in SAMPLES for seed in seeds] + [(4 * shot.reference_rays, REFERENCE_SEED)]
    try:
        pictures, seconds, load = render(shot, renders)
    except RuntimeError as error:
        return Rival(reason=str(error))
    own = pictures.pop()
    difference = float(np.mean(own, dtype=np.float64) / np.mean(reference, dtype=np.float64) - 1)
    if abs(difference) > MOST_DIFFERENCE:
        return Rival(difference=difference, reason=f"its light differs by {100 * difference:+.1f} % from that of the reference")
    frames = []
    for i, samples in enumerate(SAMPLES):
        own_seconds = seconds[i * shot.seeds:(i + 1) * shot.seeds]
        errors = [relative_error(picture, own) for picture in pictures[i * shot.seeds:(i + 1) * shot.seeds]]
        frames.append((samples, Frame(Error.of([e[0] for e in errors]), Error.of([e[1] for e in errors]), min(own_seconds))))
    return Rival(frames, load, difference)
