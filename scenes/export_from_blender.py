"""Writes the set and the camera of a Blender file (3.4) as Shadowcache reads them.

Usage: blender -b shot.blend --python-exit-code 1 -P export_from_blender.py -- SET.glb [CAMERA.json]
       blender -b shot.blend --python-exit-code 1 -P export_from_blender.py -- SET.ply CAMERA.json

SET.glb (or .gltf) has it all: instances, colours and textures, cut-outs, what moves, and every camera. SET.ply has all
that Blender would render as bare triangles, as they stand in the current frame, in Blender's own axes: bake and render
it with --up z. CAMERA.json has the scene's camera, frame by frame, with the lens, the shift and the changes of either
that glTF cannot hold; beside SET.ply the scene's first frame is frame 1 there. What Blender would render and the files do not
express is printed as one list.
"""

import os
import sys

import bpy

sys.dont_write_bytecode = True  # in whatever folder the scripts are installed
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import blender_export  # noqa: E402


def print_left_out(entries):
    print("left out: %s" % ("" if entries else "nothing"))
    for entry in entries:
        print("  " + entry)


def print_commands(path, camera):
    scene = bpy.context.scene
    name = camera or (scene.camera.name if scene.camera else "NAME")
    print("cameras: %s; then:" % (", ".join(o.name for o in scene.objects if o.type == "CAMERA") or "none"))
    print("  shadowcache-bake '%s' -o set.vdb" % path)
    print("  shadowcache-render '%s' --cache set.vdb --env MAP.exr --camera '%s' --fps %g --frames %d-%d -o shot.####.exr"
          % (path, name, scene.render.fps / scene.render.fps_base, scene.frame_start, scene.frame_end))


def export_files(depsgraph, set_frame, files):
    left_out = blender_export.export(depsgraph, files[0], set_frame)
    # Beside a glTF file frames have the scene's numbers, as what moves has.
    first = None if files[0].endswith(".ply") else 1
    return left_out + [entry for path in files[1:]
                       for entry in blender_export.export_camera(depsgraph, path, set_frame, first)]


def main():
    files = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    kinds = tuple(os.path.splitext(name)[1] for name in files)
    if kinds not in ((".glb",), (".gltf",), (".glb", ".json"), (".gltf", ".json"), (".ply", ".json")):
        sys.exit("wanted after --: SET.glb, SET.glb CAMERA.json, or SET.ply CAMERA.json")
    try:
        left_out = blender_export.with_render_depsgraph(
            lambda depsgraph, set_frame: export_files(depsgraph, set_frame, files))
    except (ValueError, OSError) as error:
        sys.exit(str(error))
    print_left_out(left_out)
    if kinds[0] != ".ply":
        print_commands(files[0], files[1] if len(files) == 2 else None)


main()
