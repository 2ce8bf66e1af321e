"""Renders a set with its own lamps by Cycles, and writes the set that it shows:
blender -b --factory-startup --python night_in_blender.py -- REQUEST.json

REQUEST.json: files (a glTF file), camera (origin, forward, up, fov), map (or null: a night without a sky) and rotate [degrees],
size [width, height], bounces, threads, samples, pictures (an .exr for each seed from 1 on), set (the .glb to write) and stats, a
JSON file that gets the processor seconds of the quickest picture, less those of a picture of one sample.

Surfaces become Lambertian, as Blender's Principled BSDF is not at any roughness: Diffuse, or Emission where they shine, and panes as a mix of
Transparent and Glossy. So both programs show the same set.
"""
import json
import os
import sys

import bpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "../../render/trade/shadowcache_trade"), os.path.join(HERE, "../../scenes")]
sys.dont_write_bytecode = True
import blender_export  # noqa: E402
import in_blender  # noqa: E402
from in_blender import node_of  # noqa: E402


def make_lambertian(material):
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
        if inputs["Emission"].is_linked or any(inputs["Emission"].default_value[:3]):
            shader = node_of(tree, "ShaderNodeEmission", Color=inputs["Emission"], Strength=inputs["Emission Strength"])
    tree.links.new(shader, tree.get_output_node("CYCLES").inputs["Surface"])


def soften(lamp):
    """What glTF says of a lamp's size, which Blender's importer leaves out."""
    lamp.shadow_soft_size = lamp.get("radius", 0.0)


def main():
    with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
        request = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    in_blender.import_gltf(request["files"][0])
    for material in bpy.data.materials:
        make_lambertian(material)
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
    pictures = request["pictures"]
    in_blender.render(pictures[0], 1, 0)  # builds what later pictures use again
    least = min(in_blender.render(pictures[0], 1, 0) for _ in range(2))
    seconds = [in_blender.render(picture, request["samples"], seed) for seed, picture in enumerate(pictures, 1)]
    with open(request["stats"], "w", encoding="utf-8") as file:
        json.dump({"processor_seconds": min(seconds) - least, "left_out": left_out}, file)


main()
