"""Files without an end, or larger than memory, in each place where the programs read one: endless_files.py SOURCE BUILD WORK

Each ends at once with status 1, or 2 for a command line's, and one line that names the file; no memory is filled.
"""
import json
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

BUILD, WORK = Path(sys.argv[2]), Path(sys.argv[3])
MOST_SECONDS, MOST_MEMORY = 20, 400e6
SET = "v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 4 3 2\n"
TRACK = {"cam": {"yfov": 0.8, "fps": 24, "frames": [{"origin": [3, 2.5, 4], "forward": [-3, -2.2, -4], "up": [0, 1, 0]}]}}
LIGHT, CAMERA = ["--env", "1,1,1"], ["--camera", "camera.json"]
PICTURE = ["-o", "out.exr", "--size", "16x9", "--spp", "1", "--bounces", "0"]

# Program, words with the file in place of FILE, extensions.
CASES = [
    ("bake/shadowcache-bake", ["FILE", "-o", "out.vdb"], ("obj", "ply", "stl", "off", "om", "glb", "gltf")),
    ("bake/shadowcache-bake", ["set.obj", "-o", "out.vdb", *CAMERA, "--lookups", "FILE"], ("lookups",)),
    ("bake/shadowcache-bake", ["set.obj", "-o", "out.vdb", "--extend", "FILE"], ("vdb",)),
    ("bake/shadowcache-bake", ["set.obj", "-o", "out.vdb", "--camera", "FILE"], ("json",)),
    ("bake/shadowcache-bake", ["--config", "FILE"], ("toml",)),
    ("bake/shadowcache-info", ["FILE"], ("vdb",)),
    ("bake/shadowcache-merge", ["FILE", "FILE", "-o", "out.vdb"], ("vdb",)),
    ("render/shadowcache-render", ["set.obj", "--env", "FILE", *CAMERA, *PICTURE], ("exr", "hdr")),
    ("render/shadowcache-render", ["set.obj", *LIGHT, "--camera", "FILE", *PICTURE], ("json",)),
    ("render/shadowcache-render", ["set.obj", *LIGHT, *CAMERA, "--cache", "FILE", *PICTURE], ("vdb",)),
    ("render/shadowcache-render", ["set.obj", *LIGHT, *CAMERA, "--cache", "FILE", "--memory", "1G", *PICTURE], ("vdb",)),
    ("render/shadowcache-render", ["set.obj", *LIGHT, *CAMERA, "--dynamic", "FILE", *PICTURE], ("obj", "glb")),
    ("render/shadowcache-render", ["set.obj", *LIGHT, *CAMERA, "--dynamic", "set.obj@FILE", *PICTURE], ("json",)),
    ("render/shadowcache-render", ["set.obj", *LIGHT, *CAMERA, "--reference", "FILE", *PICTURE], ("exr",)),
    ("render/shadowcache-render", ["--config", "FILE"], ("toml",)),
]
# A pipe without a writer is for who waits: settings may come through one.
KINDS = {"zero": lambda path: path.symlink_to("/dev/zero"), "pipe": os.mkfifo,
         "large": lambda path: (path.touch(), os.truncate(path, 1 << 42))}  # of zeros that take no place


def run(program, words):
    return subprocess.run([BUILD / program, *words], cwd=WORK, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=MOST_SECONDS, check=False)


def serve(file):
    """Each place where a request names a file."""
    requests = [{"request": "load", "set": [file + ".obj"]}, {"request": "load", "set": ["set.obj"], "cache": file + ".vdb"},
                {"request": "load", "set": ["set.obj"]}, {"request": "environment", "map": file + ".exr"},
                {"request": "environment", "radiance": 1}, {"request": "camera", "name": file + ".json"},
                {"request": "camera", "name": "camera.json"}, {"request": "size", "width": 8, "height": 8},
                {"request": "options", "spp": 1, "bounces": 0}, {"request": "render", "pixels": file + ".exr"}, {"request": "quit"}]
    lines = "".join(json.dumps({"id": number, **request}) + "\n" for number, request in enumerate(requests))
    told = subprocess.run([BUILD / "render/shadowcache-render", "--serve"], cwd=WORK, input=lines, capture_output=True, text=True,
                          timeout=MOST_SECONDS, check=False)
    replies = {reply["id"]: reply for reply in map(json.loads, told.stdout.splitlines()) if reply["reply"] in ("done", "error")}
    assert told.returncode == 0 and told.stderr == "", told.stderr
    for number, request in enumerate(requests):
        expected = "error" if file in json.dumps(request) else "done"
        assert replies[number]["reply"] == expected, (request, replies[number])
        assert expected == "done" or file in replies[number]["error"], replies[number]


def main():
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    (WORK / "set.obj").write_text(SET, encoding="utf-8")
    (WORK / "camera.json").write_text(json.dumps(TRACK), encoding="utf-8")
    tried = 0
    for kind, make in KINDS.items():
        for extension in {extension for _, _, extensions in CASES for extension in extensions}:
            make(WORK / f"{kind}.{extension}")
        for program, words, extensions in CASES:
            for extension in extensions:
                if (kind, extension) == ("pipe", "toml"):
                    continue
                file = f"{kind}.{extension}"
                told = run(program, [word.replace("FILE", file) for word in words])
                lines = told.stderr.splitlines()
                usage = extension == "toml"
                assert told.returncode == (2 if usage else 1), (file, words, told)
                assert len(lines) == (2 if usage else 1) and ("settings file" if usage else file) in lines[0], (words, lines)
                assert "filesystem error" not in lines[0] and "out of memory" not in lines[0], lines
                tried += 1
        serve(kind)
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1e3
    assert memory < MOST_MEMORY, f"{memory / 1e6:.0f} MB"
    # The control: the same words with files that are there.
    assert run("render/shadowcache-render", ["set.obj", *LIGHT, *CAMERA, *PICTURE]).returncode == 0
    print(f"{tried} refusals, {memory / 1e6:.0f} MB at most")


main()
