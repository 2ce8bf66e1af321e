"""Packs the render engine and runs its cases in a real Blender: blender_engine.py SOURCE BUILD WORK

Exit status 77 where Blender is missing, unless SHADOWCACHE_NO_SKIP is set. A Blender that is killed leaves no process.
"""
import subprocess
import time

from blender_run import BUILD, MAP, SOURCE, WORK, begin, blender, finish, servers

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


def killed(archive):
    """Blender dies in mid-render."""
    with open(WORK / "killed.log", "wb") as log:
        process = blender("-b", "--python-expr", ENDLESS, "--", archive, BUILD, stdout=log, stderr=log)
        deadline = time.monotonic() + 60
        while "Render: " not in (WORK / "killed.log").read_text(errors="replace"):
            assert time.monotonic() < deadline and process.poll() is None, (WORK / "killed.log").read_text()
            time.sleep(0.1)
        assert servers()
        process.kill()
        process.wait()
    deadline = time.monotonic() + 20  # it looks up after each of its tiles
    while servers():
        assert time.monotonic() < deadline, "the process goes on without Blender"
        time.sleep(0.05)


def main():
    archive = begin("blender")
    write_big_map()
    finish(blender("-b", "-P", SOURCE / "tests/programs/blender_engine_cases.py", "--", archive, BUILD, MAP, WORK,
                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True), MOST_SECONDS)
    killed(archive)


main()
