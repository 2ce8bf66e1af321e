# Writes the set and the camera of a Blender file (3.4) as Shadowcache reads them:
#   blender -b shot.blend -P scenes/export_from_blender.py -- set.ply camera.json
# All meshes that Blender would render, with modifiers, become one PLY in Blender's own axes (bake and render it with
# --up z). The scene's camera becomes one entry a frame, in the world that --up z makes: +Y up.
import json
import math
import sys

import bpy

set_file, camera_file = sys.argv[sys.argv.index("--") + 1:]
scene = bpy.context.scene
graph = bpy.context.evaluated_depsgraph_get()

vertices, faces = [], []
for instance in graph.object_instances:
    thing = instance.object
    if thing.type != "MESH" or not instance.show_self or thing.original.hide_render:
        continue
    mesh = thing.to_mesh()
    first = len(vertices)
    vertices += [instance.matrix_world @ v.co for v in mesh.vertices]
    faces += [[first + i for i in p.vertices] for p in mesh.polygons]
    thing.to_mesh_clear()
with open(set_file, "w") as out:
    out.write("ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\n"
              "property double z\nelement face %d\nproperty list int int vertex_indices\nend_header\n"
              % (len(vertices), len(faces)))
    for v in vertices:
        out.write("%.9g %.9g %.9g\n" % tuple(v))
    for f in faces:
        out.write("%d %s\n" % (len(f), " ".join(map(str, f))))


def turned(v):
    """Blender's +Z up to +Y up."""
    return [v.x, v.z, -v.y]


frames = []
for frame in range(scene.frame_start, scene.frame_end + 1):
    scene.frame_set(frame)
    pose = scene.camera.matrix_world
    axes = pose.to_3x3().normalized()
    frames.append({"origin": turned(pose.translation), "forward": turned(-axes.col[2]),
                   "up": turned(axes.col[1])})
render = scene.render
across = scene.camera.data.angle_x
aspect = render.resolution_x / render.resolution_y
with open(camera_file, "w") as out:
    json.dump({"cam": {"yfov": 2 * math.atan(math.tan(across / 2) / aspect),
                                   "fps": render.fps, "frames": frames}}, out)
print("%d vertices, %d faces, %d frames" % (len(vertices), len(faces), len(frames)))
