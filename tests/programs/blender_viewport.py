"""Runs the viewport of the render engine in a Blender with a window, on a display of its own: SOURCE BUILD WORK

Exit status 77 where Blender or Xvfb is missing, unless SHADOWCACHE_NO_SKIP is set. No process may be left.
"""
import subprocess
import sys
import time

from blender_run import BUILD, MAP, SOURCE, WORK, begin, blender, finish, servers

MOST_SECONDS = 200


def main():
    archive = begin("blender", "Xvfb")
    display = subprocess.Popen(["Xvfb", "-displayfd", "1", "-screen", "0", "1024x768x24", "-nolisten", "tcp"],
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        number = display.stdout.readline().strip()
        finish(blender("--window-geometry", "0", "0", "640", "480", "-P",
                       SOURCE / "tests/programs/blender_viewport_cases.py", "--", archive, BUILD, MAP, WORK,
                       environment={"DISPLAY": ":" + number}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                       text=True), MOST_SECONDS)
    finally:
        display.terminate()
        display.wait()
    deadline = time.monotonic() + 5
    while servers():
        if time.monotonic() > deadline:
            sys.exit("a process is left")
        time.sleep(0.05)


main()
