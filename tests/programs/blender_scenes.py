"""What a scene shows is right, or named: small scenes of one feature each, by the packed render engine in a real Blender,
and the allow-list against all that this Blender lists: blender_scenes.py SOURCE BUILD WORK

With --cycles behind, Cycles renders them, and its values are stored. SHADOWCACHE_ONLY="plain cubic" takes these alone. Exit status 77 where Blender is missing, unless
SHADOWCACHE_NO_SKIP is set.
"""
import subprocess
import sys

from blender_run import BUILD, MAP, SOURCE, WORK, begin, blender, finish

MOST_SECONDS = 350


def main():
    archive = begin("blender")
    finish(blender("-b", "-P", SOURCE / "tests/programs/blender_allowed.py", "--", SOURCE / "scenes",
                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True), MOST_SECONDS)
    store = {"SHADOWCACHE_STORE": "1"} if sys.argv[4:] == ["--cycles"] else {}
    finish(blender("-b", "-P", SOURCE / "tests/programs/blender_scenes_cases.py", "--", archive, BUILD, MAP, WORK,
                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, environment=store), MOST_SECONDS)


main()
