"""Makes and renders hybrids of the packed engine and Cycles in a real Blender: blender_hybrid.py SOURCE BUILD WORK

Exit status 77 where Blender is missing, unless SHADOWCACHE_NO_SKIP is set.
"""
import subprocess

from blender_run import BUILD, MAP, SOURCE, WORK, begin, blender, finish

MOST_SECONDS = 400


def main():
    archive = begin("blender")
    finish(blender("-b", "-P", SOURCE / "tests/programs/blender_hybrid_cases.py", "--", archive, BUILD, MAP, WORK,
                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True), MOST_SECONDS)


main()
