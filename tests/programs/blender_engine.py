"""Packs the render engine and runs its cases in a real Blender: blender_engine.py SOURCE BUILD WORK

Exit status 77 where Blender is missing, unless SHADOWCACHE_NO_SKIP is set. A Blender that is killed leaves no process.
"""
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

SOURCE, BUILD, WORK = (Path(word) for word in sys.argv[1:4])
SKIP = 77
MOST_SECONDS = 400
ENDLESS = """
import bpy, sys
zip, programs = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.preferences.addon_install(filepath=zip)
bpy.ops.preferences.addon_enable(module="shadowcache")
bpy.context.preferences.addons["shadowcache"].preferences.folder = programs
settings = bpy.context.scene.shadowcache
settings.camera_rays = 65536
bpy.context.scene.render.engine = "SHADOWCACHE"
bpy.ops.render.render()
"""


def write_big_map():
    """A map that takes a while: flat pixels of a Radiance file."""
    row = b"".join(bytes((40 + x % 180, 90, 30 + x % 7, 128)) for x in range(4096))
    (WORK / "big.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2048 +X 4096\n" + row * 2048)


def blender(*words, **options):
    """Blender with the system's Python, which it finds by PATH: that may begin with the folder of another."""
    path = os.pathsep.join(["/usr/bin", os.environ["PATH"]])
    return subprocess.Popen(["blender", "-b", "--factory-startup", "--python-exit-code", "1", *words], cwd=WORK,
                            env={**os.environ, "PATH": path, "BLENDER_USER_SCRIPTS": str(WORK / "scripts")}, **options)


def runs(word):
    """Processes whose command line has a word in it."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if word.encode() in path.read_bytes().replace(b"\0", b" "):
                found.append(path)
        except OSError:
            pass
    return found


def killed(archive):
    """Blender dies in mid-render."""
    with open(WORK / "killed.log", "wb") as log:
        process = blender("--python-expr", ENDLESS, "--", archive, BUILD, stdout=log, stderr=log)
        deadline = time.monotonic() + 60
        while "Render: " not in (WORK / "killed.log").read_text(errors="replace"):
            assert time.monotonic() < deadline and process.poll() is None, (WORK / "killed.log").read_text()
            time.sleep(0.1)
        child = f"{BUILD}/render/shadowcache-render --serve"
        assert runs(child)
        process.kill()
        process.wait()
    deadline = time.monotonic() + 20  # it looks up after each of its tiles
    while runs(child):
        assert time.monotonic() < deadline, "the process goes on without Blender"
        time.sleep(0.05)


def main():
    if not shutil.which("blender"):
        print("needs Blender (Debian package: blender)")
        sys.exit(1 if os.environ.get("SHADOWCACHE_NO_SKIP") else SKIP)
    shutil.rmtree(WORK, ignore_errors=True)
    (WORK / "scripts/addons").mkdir(parents=True)
    archive = WORK / "shadowcache-blender.zip"
    subprocess.run([sys.executable, SOURCE / "render/blender/pack.py", archive], check=True)
    write_big_map()
    process = blender("-P", SOURCE / "tests/programs/blender_engine_cases.py", "--", archive, BUILD,
                      SOURCE / "scenes/maps/sunrise.exr", WORK, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        output, _ = process.communicate(timeout=MOST_SECONDS)
    except subprocess.TimeoutExpired:
        process.kill()
        output, _ = process.communicate()
    print("\n".join(line for line in output.splitlines() if line.startswith("case ")))
    if process.returncode or "all cases passed" not in output:
        print(output[-6000:])
        sys.exit(1)
    killed(archive)


main()
