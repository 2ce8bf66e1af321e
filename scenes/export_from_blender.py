"""Writes the set and the camera of a Blender file (3.4) as Shadowcache reads them.

Usage: blender -b shot.blend --python-exit-code 1 -P export_from_blender.py -- SET.glb
       blender -b shot.blend --python-exit-code 1 -P export_from_blender.py -- SET.ply CAMERA.json

SET.glb has it all: instances, colours and textures, cut-outs, what moves, and every camera. SET.ply has all that
Blender would render as bare triangles, as they stand in the current frame, in Blender's own axes: bake and render it
with --up z. CAMERA.json has the scene's camera, frame by frame; the scene's first frame is frame 1 there.
"""

import json
import math
import sys

import bpy

SOLID = {"MESH", "CURVE", "SURFACE", "FONT", "META"}


def export_gltf(path):
    scene = bpy.context.scene
    bpy.ops.export_scene.gltf(
        filepath=path, export_format="GLTF_SEPARATE" if path.endswith(".gltf") else "GLB",
        export_cameras=True, export_apply=True, use_renderable=True, export_morph=False, export_skins=False)
    name = scene.camera.name if scene.camera else "NAME"
    print("cameras: %s; then:" % (", ".join(o.name for o in scene.objects if o.type == "CAMERA") or "none"))
    print("  shadowcache-bake '%s' -o set.vdb" % path)
    print("  shadowcache-render '%s' --cache set.vdb --env MAP.exr --camera '%s' --fps %g --frames %d-%d -o shot.####.exr"
          % (path, name, scene.render.fps / scene.render.fps_base, scene.frame_start, scene.frame_end))


def hidden(thing):
    return thing.hide_render or all(c.hide_render for c in thing.users_collection)


def export_ply(path):
    vertices, faces = [], []
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        thing = instance.object
        if thing.type not in SOLID or not instance.show_self or hidden(thing.original):
            continue
        mesh = thing.to_mesh()
        first = len(vertices)
        vertices += [instance.matrix_world @ v.co for v in mesh.vertices]
        faces += [[first + i for i in p.vertices] for p in mesh.polygons]
        thing.to_mesh_clear()
    if not faces:
        sys.exit("no mesh, curve or text that would be rendered")
    with open(path, "w", encoding="ascii") as out:
        out.write("ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\n"
                  "property double z\nelement face %d\nproperty list int int vertex_indices\nend_header\n"
                  % (len(vertices), len(faces)))
        for v in vertices:
            out.write("%.9g %.9g %.9g\n" % tuple(v))
        for f in faces:
            out.write("%d %s\n" % (len(f), " ".join(map(str, f))))
    print("%d vertices, %d faces" % (len(vertices), len(faces)))


def turned(v):
    """Blender's +Z up to +Y up."""
    return [v.x, v.z, -v.y]


def export_camera(path):
    scene = bpy.context.scene
    if not scene.camera or scene.camera.data.type != "PERSP":
        sys.exit("the scene has no perspective camera")
    # Corners of the picture at distance 1: right whatever the sensor, its fit and the picture's sides are.
    corners = scene.camera.data.view_frame(scene=scene)
    tangent = max((a - b).length for a in corners for b in corners if abs(a.x - b.x) < 1e-6) / 2 / -corners[0].z
    frames = []
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        pose = scene.camera.matrix_world
        axes = pose.to_3x3().normalized()
        frames.append({"origin": turned(pose.translation), "forward": turned(-axes.col[2]),
                       "up": turned(axes.col[1])})
    with open(path, "w", encoding="ascii") as out:
        json.dump({"cam": {"yfov": 2 * math.atan(tangent), "fps": scene.render.fps / scene.render.fps_base,
                           "frames": frames}}, out)
    print("%d frames" % len(frames))


def main():
    files = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    if len(files) == 1 and files[0].endswith((".glb", ".gltf")):
        export_gltf(files[0])
    elif len(files) == 2 and files[0].endswith(".ply") and files[1].endswith(".json"):
        export_ply(files[0])
        export_camera(files[1])
    else:
        sys.exit("wanted after --: SET.glb, or SET.ply CAMERA.json")


main()
