"""Makes a small set with instances, parents and an animated camera in Blender, exports it as glTF,
and writes down where Blender itself has the camera.

Usage: blender -b --factory-startup --python-exit-code 1 --python blender_shot.py -- SET.glb POSES.json
"""

import json
import math
import sys

import bpy

FRAMES = (1, 50, 240)


def add_material(name, color):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*color, 1)
    return material


def add_object(name, data, location, parent=None):
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    thing.parent = parent
    bpy.context.scene.collection.objects.link(thing)
    return thing


def make_mesh(name, operator, material, **arguments):
    """A mesh of one of Blender's primitives, without the object it came with."""
    operator(**arguments)
    thing = bpy.context.object
    mesh = thing.data
    mesh.name = name
    mesh.materials.append(material)
    bpy.data.objects.remove(thing)
    return mesh


def make_set():
    stone = add_material("stone", (0.5, 0.45, 0.4))
    leaf = add_material("leaf", (0.1, 0.4, 0.05))
    plane = make_mesh("floor", bpy.ops.mesh.primitive_plane_add, stone, size=30)
    add_object("floor", plane, (0, 0, 0))
    crown = make_mesh("crown", bpy.ops.mesh.primitive_ico_sphere_add, leaf, subdivisions=3, radius=1)
    trunk = make_mesh("trunk", bpy.ops.mesh.primitive_cylinder_add, stone, radius=0.2, depth=2)
    for i in range(40):
        angle = 2.4 * i
        radius = 2.5 + 0.25 * i
        tree = add_object("tree", None, (radius * math.cos(angle), radius * math.sin(angle), 0))
        tree.rotation_euler = (0, 0, angle)
        # Every third one is mirrored, and of other proportions.
        tree.scale = (-1 if i % 3 == 0 else 1, 1, 0.8 + 0.02 * i)
        add_object("trunk", trunk, (0, 0, 1), tree)
        add_object("crown", crown, (0, 0, 2.6), tree)


def key(thing, path, keys):
    for frame, value in keys:
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=frame)


def make_camera():
    """A camera on a dolly on a turning stage; each of the three moves."""
    stage = add_object("stage", None, (0, 0, 0))
    dolly = add_object("dolly", None, (0, 0, 0), stage)
    camera = bpy.data.cameras.new("shot")
    camera.angle = math.radians(60)
    thing = add_object("shot", camera, (0, 0, 0), dolly)
    key(stage, "rotation_euler", [(1, (0, 0, 0)), (120, (0, 0, 0.9)), (240, (0, 0, 1.2))])
    key(dolly, "location", [(1, (0, -16, 1)), (80, (1, -12, 2)), (240, (0, -9, 4))])
    key(dolly, "scale", [(1, (1, 1, 1)), (240, (1.5, 1.5, 1.5))])
    key(thing, "rotation_euler", [(1, (1.5, 0, 0)), (240, (1.2, 0, 0.2))])
    key(thing, "location", [(1, (0, 0, 0.5)), (100, (0.5, 0, 1)), (240, (0, 0, 0.5))])
    bpy.context.scene.camera = thing
    return thing


def write_poses(camera, path):
    """Camera's place and view, in glTF's axes: +Y up."""
    poses = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        matrix = camera.matrix_world
        poses.append({
            "frame": frame,
            "origin": to_y_up(matrix.translation),
            "forward": to_y_up(-matrix.col[2].to_3d().normalized()),
            "up": to_y_up(matrix.col[1].to_3d().normalized()),
        })
    with open(path, "w", encoding="utf-8") as file:
        render = bpy.context.scene.render
        # Blender's angle is that of the longer side.
        tangent = math.tan(camera.data.angle / 2) * render.resolution_y / render.resolution_x
        json.dump({"fps": render.fps, "fov_y": 2 * math.atan(tangent), "poses": poses}, file)


def to_y_up(v):
    return [v[0], v[2], -v[1]]


def main():
    glb, poses = sys.argv[sys.argv.index("--") + 1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 240
    scene.render.fps = 24
    scene.render.resolution_x, scene.render.resolution_y = 960, 540
    make_set()
    camera = make_camera()
    write_poses(camera, poses)
    bpy.ops.export_scene.gltf(filepath=glb, export_cameras=True)


main()
