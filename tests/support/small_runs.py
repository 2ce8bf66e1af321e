"""A small set, a map, two caches of it, and the commands that tests/faults and tests/load run on them."""
import hashlib
import importlib.machinery
import importlib.util
import struct
import subprocess
import sys
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
TABLE = """v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
f 1 2 3
f 1 3 4
v -0.4 0.6 -0.4
v 0.4 0.6 -0.4
v 0.4 0.6 0.4
v -0.4 0.6 0.4
f 5 6 7
f 5 7 8
"""
BAKE = "--spacing 0.5 --level 1 --rays 2".split()
VIEW = "--eye 1,1.5,2 --look-at 0,0.3,0".split()


def load_script(name):
    """A script of tests/ without extension, as a module."""
    sys.dont_write_bytecode = True
    loader = importlib.machinery.SourceFileLoader(name, str(TESTS / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


pixels = load_script("bits").pixels


def program(build, name):
    """Path of shadowcache-NAME in a build."""
    folder = {"render": "render", "farm": "render", "make-set": "scenes"}.get(name, "bake")
    return str(build / folder / f"shadowcache-{name}")


class Case:
    """A program, its arguments and the file that it writes."""

    def __init__(self, build, name, arguments, output):
        self.program, self.name, self.output = program(build, name), f"shadowcache-{name}", output
        # On a slow machine progress is on the standard error as well.
        self.words = [self.program, *arguments.split(), *(() if name == "info" else ("--progress", "none"))]


def cases(build):
    """A run of each program, in a folder that make_inputs() filled; on two threads."""
    return [
        Case(build, "bake", f"set.obj -o new.vdb {' '.join(BAKE)} --threads 2", "new.vdb"),
        Case(build, "merge", "one.vdb two.vdb -o new.vdb", "new.vdb"),
        Case(build, "info", "one.vdb --report new.html --threads 2", "new.html"),
        Case(build, "render", f"set.obj --cache one.vdb --env map.exr {' '.join(VIEW)} --size 8x6 --samples 4 "
             "--threads 2 -o new.exr", "new.exr")]


def run(folder, *words):
    """A program that must succeed; what it printed."""
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True,
                          text=True, errors="replace")
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, words))[:400]}: status {done.returncode}: {done.stderr[-400:]}")
    return done.stdout


def make_inputs(build, folder):
    """The set, two caches of it, and a map."""
    (folder / "set.obj").write_text(TABLE)
    run(folder, program(build, "render"), "set.obj", "--env", "1,1,1", "--eye", "1,1,1", "--look-at", "0,0,0",
        "--size", "16x8", "--samples", "1", "-o", "map.exr")
    for seed, name in ((1, "one.vdb"), (2, "two.vdb")):
        run(folder, program(build, "bake"), "set.obj", "-o", name, *BAKE, "--seed", seed)


def content(path):
    """A hash of what a file holds. Of a picture only the pixels: its header has the time that it took."""
    if not path.is_file():
        return ""
    data = path.read_bytes()
    if data.startswith(b"\x76\x2f\x31\x01"):
        try:
            data = pixels(path)
        except (IndexError, ValueError, struct.error):  # not all of a picture
            pass
    return hashlib.sha256(data).hexdigest()


def contents(folder):
    """What each file below a folder holds."""
    return {str(path.relative_to(folder)): content(path) for path in sorted(folder.rglob("*"))}


def is_failure(case, status, said):
    """Whether a program failed as it must: status 1, or 75 after a signal, and one line that begins with its name."""
    return status in (1, 75) and said.count("\n") == 1 and said.startswith(case.name + ": ")
