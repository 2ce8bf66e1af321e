"""Lamps shine as in Cycles, or are named: small scenes of one lamp each, by the packed render engine in a real Blender:
blender_lamps.py SOURCE BUILD WORK

With --cycles behind, Cycles renders them, and its values are stored. SHADOWCACHE_ONLY="point sun" takes these alone. Exit
status 77 where Blender is missing, unless SHADOWCACHE_NO_SKIP is set.
"""
import subprocess
import sys

from blender_run import BUILD, MAP, SOURCE, WORK, begin, blender, finish

MOST_SECONDS = 250


def main():
    archive = begin("blender")
    store = {"SHADOWCACHE_STORE": "1"} if sys.argv[4:] == ["--cycles"] else {}
    finish(blender("-b", "-P", SOURCE / "tests/programs/blender_lamps_cases.py", "--", archive, BUILD, MAP, WORK,
                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, environment=store), MOST_SECONDS)


main()
