"""Makes small scenes in Blender, each with one feature, and exports each as .glb and .ply, with what is left out as
.txt: a plane of 10 and a cube of 1 on it.

Usage: blender -b --factory-startup --python-exit-code 1 -P blender_cases.py -- SCENES_FOLDER [MODE...]
"""

import math
import sys

import bpy

sys.path.insert(0, sys.argv[sys.argv.index("--") + 1])
import blender_export  # noqa: E402


def link(name, data, location=(0, 0, 0)):
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    bpy.context.scene.collection.objects.link(thing)
    return thing


def start():
    """The cube of a new scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_plane_add(size=10)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 0.5))
    cube = bpy.context.object
    camera = link("Cam", bpy.data.cameras.new("Cam"), (0, -6, 2))
    camera.rotation_euler = (math.radians(75), 0, 0)
    bpy.context.scene.camera = camera
    bpy.context.scene.frame_end = 3
    return cube


def move_to_collection(cube):
    """Out of the scene's collection into one of its own, which is not in the scene."""
    collection = bpy.data.collections.new("kept")
    collection.objects.link(cube)
    bpy.context.scene.collection.objects.unlink(cube)
    return collection


def shapekey(cube):
    cube.shape_key_add(name="Basis")
    key = cube.shape_key_add(name="up")
    for vertex in key.data:
        vertex.co.z += 1
    key.value = 1


def geonodes(cube):
    group = bpy.data.node_groups.new("g", "GeometryNodeTree")
    group.inputs.new("NodeSocketGeometry", "G")
    group.outputs.new("NodeSocketGeometry", "G")
    kinds = {"i": "NodeGroupInput", "o": "NodeGroupOutput", "p": "GeometryNodeDistributePointsOnFaces",
             "n": "GeometryNodeInstanceOnPoints", "c": "GeometryNodeMeshCube"}
    node = {key: group.nodes.new(kind) for key, kind in kinds.items()}
    node["p"].inputs["Density"].default_value = 5
    group.links.new(node["i"].outputs[0], node["p"].inputs[0])
    group.links.new(node["p"].outputs[0], node["n"].inputs[0])
    group.links.new(node["c"].outputs[0], node["n"].inputs["Instance"])
    group.links.new(node["n"].outputs[0], node["o"].inputs[0])
    cube.modifiers.new("g", "NODES").node_group = group


def subsurf(cube):
    modifier = cube.modifiers.new("s", "SUBSURF")
    modifier.levels, modifier.render_levels = 1, 3


def modifier_off(cube):
    subsurf(cube)
    cube.modifiers["s"].show_render = False


def eyehidden(cube):
    cube.hide_set(True)


def screen_hidden(cube):
    cube.hide_viewport = True


def render_hidden(cube):
    cube.hide_render = True


def excluded(cube):
    collection = move_to_collection(cube)
    bpy.context.scene.collection.children.link(collection)
    bpy.context.view_layer.layer_collection.children["kept"].exclude = True


def collection_hidden(cube):
    collection = move_to_collection(cube)
    bpy.context.scene.collection.children.link(collection)
    collection.hide_render = True


def collection_instances(cube):
    """Three, one of them mirrored, one sheared."""
    collection = move_to_collection(cube)
    for k in range(3):
        empty = link("empty", None, (2 * k, 0, 0))
        empty.instance_type, empty.instance_collection = "COLLECTION", collection
        empty.scale = ((1, 1, 1), (-1, 1, 1), (1, 2, 3))[k]
    cube.rotation_euler = (0, 0.5, 0)


def negative(cube):
    cube.scale = (1, 1, -1)


def smooth(cube):
    bpy.ops.object.shade_smooth()


def auto_smooth(cube):
    bpy.ops.object.shade_smooth(use_auto_smooth=True)


def custom_normals(cube):
    auto_smooth(cube)
    cube.data.normals_split_custom_set([(0, 0, 1)] * len(cube.data.loops))


def ngon(cube):
    bpy.ops.mesh.primitive_circle_add(vertices=7, radius=1, fill_type="NGON", location=(0, 0, 2))


def text(cube):
    body = bpy.data.curves.new("text", "FONT")
    body.body, body.extrude = "I", 0.1
    link("text", body)


def curve(cube):
    bpy.ops.curve.primitive_bezier_circle_add()
    bpy.context.object.data.bevel_depth = 0.1
    bpy.context.object.data.render_resolution_u = 2


def meta(cube):
    bpy.ops.object.metaball_add(location=(3, 0, 1))


def colours(cube):
    """Half grey of sRGB, .214 in linear, seen by the material; the plane has colours that its material does not use."""
    for thing in (cube, bpy.data.objects["Plane"]):
        thing.data.color_attributes.new("tint", "BYTE_COLOR", "CORNER")
        for item in thing.data.color_attributes["tint"].data:
            item.color_srgb = (0.5, 0.5, 0.5, 1)
        material = bpy.data.materials.new(thing.name)
        material.use_nodes = True
        thing.data.materials.append(material)
    tree = cube.data.materials[0].node_tree
    node = tree.nodes.new("ShaderNodeVertexColor")
    node.layer_name = "tint"
    tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])


def textured(cube):
    """One image in colour and opacity, at half its size; emission; and what cannot be expressed."""
    image = bpy.data.images.new("check", 2, 2, alpha=True)
    image.pixels = [1, 0, 0, 1, 0, 1, 0, 0.5, 0, 0, 1, 1, 1, 1, 1, 1]
    material = bpy.data.materials.new("check")
    material.use_nodes, material.blend_method = True, "CLIP"
    cube.data.materials.append(material)
    tree = material.node_tree
    shader = tree.nodes["Principled BSDF"]
    node, place, where = (tree.nodes.new(k) for k in ("ShaderNodeTexImage", "ShaderNodeMapping", "ShaderNodeTexCoord"))
    node.image, node.interpolation = image, "Closest"
    place.inputs["Scale"].default_value = (2, 2, 2)
    tree.links.new(where.outputs["UV"], place.inputs["Vector"])
    tree.links.new(place.outputs["Vector"], node.inputs["Vector"])
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    tree.links.new(node.outputs["Alpha"], shader.inputs["Alpha"])
    shader.inputs["Emission"].default_value = (1, 0.5, 0, 1)
    shader.inputs["Emission Strength"].default_value = 4
    shader.inputs["Clearcoat"].default_value = 1
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs["Fac"], shader.inputs["Roughness"])


def vanishing(cube):
    """There in frame 1 only."""
    for frame, hidden in ((1, False), (2, True)):
        cube.hide_render = hidden
        cube.keyframe_insert("hide_render", frame=frame)


def moving(cube):
    """A child whose parent's scale shears it, and turns with the frame."""
    parent = link("parent", None)
    parent.scale = (1, 2, 1)
    cube.parent = parent
    for frame in (1, 3):
        cube.rotation_euler = (0, 0, 0.4 * frame)
        cube.keyframe_insert("rotation_euler", frame=frame)


def deforming(cube):
    shapekey(cube)
    key = cube.data.shape_keys.key_blocks["up"]
    key.keyframe_insert("value", frame=1)
    key.value = 0
    key.keyframe_insert("value", frame=3)
    bpy.context.scene.frame_set(1)


def no_camera(cube):
    bpy.data.objects.remove(bpy.context.scene.camera)


def lamp(cube):
    link("lamp", bpy.data.lights.new("lamp", "POINT"))
    cube.visible_camera = False


MODES = (shapekey, geonodes, subsurf, modifier_off, eyehidden, screen_hidden, render_hidden, excluded,
         collection_hidden, collection_instances, negative, smooth, auto_smooth, custom_normals, ngon, text, curve,
         meta, colours, textured, vanishing, moving, deforming, no_camera, lamp)


def export(name):
    def work(depsgraph, set_frame):
        blender_export.export(depsgraph, name + ".ply")
        return blender_export.export(depsgraph, name + ".glb", set_frame)

    with open(name + ".txt", "w", encoding="utf-8") as out:
        out.writelines(entry + "\n" for entry in blender_export.with_render_depsgraph(work))


def main():
    wanted = sys.argv[sys.argv.index("--") + 2:]
    for mode in MODES:
        if not wanted or mode.__name__ in wanted:
            mode(start())
            export(mode.__name__)


main()
