"""Starts Blender with the packed render engine, for tests."""
import os
import shutil
import subprocess
import sys
from pathlib import Path

SOURCE, BUILD, WORK = (Path(word) for word in sys.argv[1:4])
MAP = SOURCE / "scenes/maps/sunrise.exr"
SKIP = 77


def begin(*needed):
    """Path of the packed engine, in an empty folder WORK. Ends the test where a program is missing."""
    for name in needed:
        if not shutil.which(name):
            print(f"needs {name} (Debian package: {name.lower()})")
            sys.exit(1 if os.environ.get("SHADOWCACHE_NO_SKIP") else SKIP)
    shutil.rmtree(WORK, ignore_errors=True)
    (WORK / "scripts/addons").mkdir(parents=True)
    archive = WORK / "shadowcache-blender.zip"
    subprocess.run([sys.executable, SOURCE / "render/blender/pack.py", archive], check=True)
    return archive


def blender(*words, **options):
    """Blender with the system's Python, which it finds by PATH: that may begin with the folder of another."""
    path = os.pathsep.join(["/usr/bin", os.environ["PATH"]])
    environment = {**os.environ, "PATH": path, "BLENDER_USER_SCRIPTS": str(WORK / "scripts"),
                   **options.pop("environment", {})}
    return subprocess.Popen(["blender", "--factory-startup", "--python-exit-code", "1", *words], cwd=WORK,
                            env=environment, **options)


def finish(process, most_seconds):
    """Waits for Blender, whose script must say that all cases passed."""
    try:
        output, _ = process.communicate(timeout=most_seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        output, _ = process.communicate()
    print("\n".join(line for line in output.splitlines() if line.startswith("case ")))
    if process.returncode or "all cases passed" not in output:
        print(output[-6000:])
        sys.exit(1)


def servers():
    """Processes with --serve of this test's Blenders: others may run beside it."""
    own = b"BLENDER_USER_SCRIPTS=" + os.fsencode(WORK / "scripts")
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if (b"--serve" in (process / "cmdline").read_bytes().split(b"\0")
                    and own in (process / "environ").read_bytes().split(b"\0")):
                found.append(process)
        except OSError:  # it has ended
            pass
    return found
