"""Renders a frame of a set with Blender's Cycles: diffuse light of a map alone, as shadowcache-render does.

Usage: blender -b --factory-startup --python-exit-code 1 --python render_in_cycles.py -- REQUEST.json

REQUEST.json: set (binary PLY of triangles, +Y up), map, camera (camera file), frame, size [width, height], albedo,
samples of a pixel, bounces, threads, pictures (an .exr for each seed from 1 on) and stats, a JSON file that gets the processor
seconds of the quickest picture, less those of a picture of one sample, which reads and writes as much.
"""

import json
import os
import sys

import bpy
import numpy
from mathutils import Vector

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../render/trade/shadowcache_trade"))
from in_blender import axes_of, choose_settings, render  # noqa: E402


def to_blender(vectors):
    """Our +Y up to Blender's +Z up, so that the middle of the map is where it is for us."""
    return numpy.asarray(vectors)[..., [2, 0, 1]]


def read_ply(path):
    """Vertices (n, 3) and triangles (m, 3) of the only form that the benchmark's sets have."""
    with open(path, "rb") as file:
        header = []
        while not header or header[-1] != "end_header":
            header.append(file.readline().decode().strip())
        properties = [line for line in header if line.startswith("property")]
        wanted = [f"property float {axis}" for axis in "xyz"] + ["property list uchar int vertex_indices"]
        if header[1] != "format binary_little_endian 1.0" or properties != wanted:
            raise SystemExit(f"{path}: {header[1]}, {properties}; wanted binary_little_endian, {wanted}")
        count = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element")}
        vertices = numpy.fromfile(file, "<f4", 3 * count["vertex"]).reshape(-1, 3)
        faces = numpy.fromfile(file, [("corners", "u1"), ("vertices", "<i4", 3)], count["face"])
    if not (faces["corners"] == 3).all():
        raise SystemExit(f"{path}: has faces that are no triangles")
    return vertices, faces["vertices"]


def add_set(path, albedo):
    vertices, triangles = read_ply(path)
    mesh = bpy.data.meshes.new("set")
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", to_blender(vertices).ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", triangles.ravel())
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", numpy.arange(0, triangles.size, 3))
    mesh.polygons.foreach_set("loop_total", numpy.full(len(triangles), 3))
    mesh.update()
    material = bpy.data.materials.new("diffuse")
    material.use_nodes = True
    tree = material.node_tree
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (albedo, albedo, albedo, 1)
    tree.links.new(diffuse.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("set", mesh))


def add_camera(path, frame):
    with open(path, encoding="utf-8") as file:
        track = json.load(file)["cam"]
    pose = track["frames"][frame - 1]
    axes = axes_of(Vector(to_blender(pose["forward"])), Vector(to_blender(pose["up"])))
    axes.translation = to_blender(pose["origin"])
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.angle = track["yfov"]
    camera.clip_start = 1e-4
    thing = bpy.data.objects.new("camera", camera)
    thing.matrix_world = axes
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.scene.camera = thing


def add_sky(path):
    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    world.use_nodes = True
    texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(path)
    world.node_tree.links.new(texture.outputs["Color"], world.node_tree.nodes["Background"].inputs["Color"])


def main():
    with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
        request = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    add_set(request["set"], request["albedo"])
    add_camera(request["camera"], request["frame"])
    add_sky(request["map"])
    choose_settings(request)
    pictures = request["pictures"]
    render(pictures[0], 1, 0)  # builds what later pictures use again
    least = min(render(pictures[0], 1, 0) for _ in range(2))
    seconds = [render(picture, request["samples"], seed) for seed, picture in enumerate(pictures, 1)]
    with open(request["stats"], "w", encoding="utf-8") as file:
        json.dump({"processor_seconds": min(seconds) - least}, file)


main()
