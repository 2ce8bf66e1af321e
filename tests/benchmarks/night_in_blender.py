"""Renders a set with its own lamps by Cycles, and writes the set that it shows:
blender -b --factory-startup --python night_in_blender.py -- REQUEST.json

REQUEST.json: files (a glTF file), camera (origin, forward, up, fov), map (or null: a night without a sky) and rotate [degrees],
size [width, height], bounces, threads, samples, pictures (an .exr for each seed from 1 on), set (the .glb to write) and stats, a
JSON file that gets the processor seconds of the quickest picture, less those of a picture of one sample. With lamps false nothing of
the set shines; portal, or null: two opposite corners of an upright rectangle along an axis, +Y up; adaptive: the noise threshold of
adaptive sampling, with four times the samples at most, or null.

Surfaces become Lambertian, as Blender's Principled BSDF is not at any roughness: Diffuse, or Emission where they shine, and panes as a mix of
Transparent and Glossy. So both programs show the same set.
"""
import json
import os
import sys

import bpy
from mathutils import Vector

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "../../render/trade/shadowcache_trade"), os.path.join(HERE, "../../scenes")]
sys.dont_write_bytecode = True
import blender_export  # noqa: E402
import in_blender  # noqa: E402
from in_blender import Y_UP, axes_of, node_of  # noqa: E402


def make_lambertian(material, shines):
    tree = material.node_tree
    principled = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    inputs = principled.inputs
    if inputs["Transmission"].default_value > 0:
        clear = node_of(tree, "ShaderNodeBsdfTransparent", Color=inputs["Base Color"])
        mirror = node_of(tree, "ShaderNodeBsdfGlossy", Color=(1, 1, 1, 1), Roughness=0.0)
        fresnel = node_of(tree, "ShaderNodeFresnel", IOR=inputs["IOR"])
        shader = node_of(tree, "ShaderNodeMixShader", _0=fresnel, _1=clear, _2=mirror)
    else:
        shader = node_of(tree, "ShaderNodeBsdfDiffuse", Color=inputs["Base Color"])
        if shines and (inputs["Emission"].is_linked or any(inputs["Emission"].default_value[:3])):
            shader = node_of(tree, "ShaderNodeEmission", Color=inputs["Emission"], Strength=inputs["Emission Strength"])
    tree.links.new(shader, tree.get_output_node("CYCLES").inputs["Surface"])


def soften(lamp):
    """What glTF says of a lamp's size, which Blender's importer leaves out."""
    lamp.shadow_soft_size = lamp.get("radius", 0.0)


def add_portal(corners, eye):
    """A window for Cycles' sky, which shines to the side of the eye."""
    low, high = (Y_UP @ Vector(corner) for corner in corners)
    middle, size = (low + high) / 2, [abs(a) for a in high - low]
    across = min((0, 1), key=lambda axis: size[axis])  # it is upright
    inwards = Vector([0.0, 0.0, 0.0])
    inwards[across] = 1.0 if eye[across] > middle[across] else -1.0
    lamp = bpy.data.lights.new("portal", "AREA")
    lamp.shape, lamp.cycles.is_portal = "RECTANGLE", True
    lamp.size, lamp.size_y = size[1 - across], size[2]
    thing = bpy.data.objects.new("portal", lamp)
    thing.matrix_world = axes_of(inwards, Vector((0, 0, 1)))
    thing.location = middle
    bpy.context.scene.collection.objects.link(thing)


def main():
    with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
        request = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    in_blender.import_gltf(request["files"][0])
    for material in bpy.data.materials:
        make_lambertian(material, request["lamps"])
    if not request["lamps"]:
        for thing in [thing for thing in bpy.data.objects if thing.type == "LIGHT"]:
            bpy.data.objects.remove(thing)
    for lamp in bpy.data.lights:
        soften(lamp)
    in_blender.add_camera(request["camera"])
    if request["map"]:
        in_blender.add_sky(request["map"], request["rotate"])
    in_blender.choose_settings(request)
    cycles = bpy.context.scene.cycles
    cycles.transparent_max_bounces = cycles.transmission_bounces = 64
    left_out = blender_export.with_render_depsgraph(
        lambda depsgraph, set_frame: blender_export.export(depsgraph, request["set"], set_frame))
    print("left out:", left_out)
    samples = request["samples"]
    if request["portal"]:
        add_portal(request["portal"], bpy.context.scene.camera.matrix_world.translation)
    if request["adaptive"]:
        cycles.use_adaptive_sampling, cycles.adaptive_threshold = True, request["adaptive"]
        samples *= 4
    pictures = request["pictures"]
    in_blender.render(pictures[0], 1, 0)  # builds what later pictures use again
    least = min(in_blender.render(pictures[0], 1, 0) for _ in range(2))
    seconds = [in_blender.render(picture, samples, seed) for seed, picture in enumerate(pictures, 1)]
    with open(request["stats"], "w", encoding="utf-8") as file:
        json.dump({"processor_seconds": min(seconds) - least, "left_out": left_out}, file)


main()
