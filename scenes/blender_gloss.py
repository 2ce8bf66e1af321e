"""Makes a small set of smooth, textured and glossy things in Blender, exports it as glTF, and renders it with Cycles.

Usage: blender -b --factory-startup --python-exit-code 1 --python blender_gloss.py -- MAP.exr SET.glb PICTURE.exr SAMPLES
       [WIDTH HEIGHT [BOUNCES]]     of the picture [160 90 0]

Exported are Blender's own materials (Principled BSDF). Cycles then renders the BRDF that glTF's specification makes of
them, built from nodes: a dielectric whose reflectance is the same at all angles is a mix of Diffuse and Glossy by that
share, and a white metal is Glossy alone. The glTF file asks for that reflectance through KHR_materials_specular, which
is added to it. Light is that of the map, which met up to BOUNCES surfaces before the one that is seen. Cycles 3.4
multiplies masking and shadowing, which the specification correlates; below a roughness of 0.6 and away from grazing angles that is hardly seen.
"""

import json
import math
import struct
import sys

import bpy

# Name, metallic, reflectance of the dielectric, roughness. The first has a normal map and nothing diffuse: where a
# normal map bends the normal, Cycles darkens the diffuse part alone (Chiang et al. 2019).
LOOKS = (("floor", 0, 1, 0.5), ("smooth", 0, 0.5, 0.1), ("satin", 0, 0.5, 0.3), ("rough", 0, 0.5, 0.5),
         ("chrome", 1, 1, 0.1), ("steel", 1, 1, 0.25), ("lead", 1, 1, 0.5))


def picture(name, colour_space, texel):
    """A picture of 64 x 64 texels, texel(x, y) of each in [0, 1]."""
    image = bpy.data.images.new(name, 64, 64)
    image.colorspace_settings.name = colour_space
    image.pixels = [c for y in range(64) for x in range(64) for c in (*texel(x, y), 1)]
    image.pack()
    return image


def check(x, y):
    return (0.7, 0.6, 0.4) if (x // 8 + y // 8) % 2 else (0.25, 0.3, 0.45)


def rough(x, y):
    return 0, 0.25 + 0.25 * (x // 16 % 2), 0


def bumps(x, y):
    slope_x, slope_y = 0.25 * math.sin(x / 64 * 8 * math.pi), 0.25 * math.cos(y / 64 * 4 * math.pi)
    length = math.sqrt(1 + slope_x ** 2 + slope_y ** 2)
    return tuple(0.5 + 0.5 * c / length for c in (slope_x, slope_y, 1))


def add_texture(tree, image):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    return node


def add_material(name, metallic, roughness):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    inputs = tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value = (1, 1, 1, 1) if metallic else (0.6, 0.3, 0.2, 1)
    inputs["Metallic"].default_value = metallic
    inputs["Roughness"].default_value = roughness
    if name == "satin":
        tree.links.new(add_texture(tree, picture("check", "sRGB", check)).outputs["Color"], inputs["Base Color"])
    if name == "floor":
        channels = tree.nodes.new("ShaderNodeSeparateColor")
        tree.links.new(add_texture(tree, picture("rough", "Non-Color", rough)).outputs["Color"], channels.inputs[0])
        tree.links.new(channels.outputs["Green"], inputs["Roughness"])
        normal = tree.nodes.new("ShaderNodeNormalMap")
        tree.links.new(add_texture(tree, picture("bumps", "Non-Color", bumps)).outputs["Color"], normal.inputs["Color"])
        tree.links.new(normal.outputs["Normal"], inputs["Normal"])
    return material


def make_set():
    for i, (name, metallic, _, roughness) in enumerate(LOOKS):
        if name == "floor":
            bpy.ops.mesh.primitive_plane_add(size=12)
        else:
            place = (((i - 1) % 3 - 1) * 2.1, 2.2 * ((i - 1) // 3), 1)
            bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1, location=place)
            bpy.ops.object.shade_smooth()
        bpy.context.object.data.materials.append(add_material(name, metallic, roughness))
    camera = bpy.data.cameras.new("still")
    camera.angle = math.radians(40)
    thing = bpy.data.objects.new("still", camera)
    # From above: where a bent normal would reflect the viewer into the floor, Cycles bends it back.
    thing.location = (0, -6.5, 9)
    thing.rotation_euler = (math.radians(40), 0, 0)
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.scene.camera = thing


def add_reflectance(path):
    """Gives the dielectrics of a .glb the reflectances of LOOKS, at all angles."""
    with open(path, "rb") as file:
        data = file.read()
    size, = struct.unpack_from("<I", data, 12)
    document = json.loads(data[20 : 20 + size])
    for material in document["materials"]:
        look = next(look for look in LOOKS if look[0] == material["name"])
        # More than 1 / 0.04: reflects everything head on, too, before the factor.
        material["extensions"] = {
            "KHR_materials_specular": {"specularFactor": look[2], "specularColorFactor": [100, 100, 100]}}
    used = set(document.get("extensionsUsed", [])) | {"KHR_materials_specular"}
    document["extensionsUsed"] = sorted(used)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + size :]
    with open(path, "wb") as file:
        file.write(b"glTF" + struct.pack("<II", 2, 20 + len(text) + len(rest)) + struct.pack("<I", len(text)) +
                   b"JSON" + text + rest)


def source_of(inputs, name):
    return inputs[name].links[0].from_socket if inputs[name].is_linked else inputs[name].default_value


def connect(tree, source, target):
    if isinstance(source, bpy.types.NodeSocket):
        tree.links.new(source, target)
    else:
        target.default_value = source


def use_nodes_of_the_brdf(material, metallic, reflectance):
    tree = material.node_tree
    principled = tree.nodes["Principled BSDF"].inputs
    glossy = tree.nodes.new("ShaderNodeBsdfGlossy")
    glossy.distribution = "GGX"
    glossy.inputs["Color"].default_value = (1, 1, 1, 1)
    connect(tree, source_of(principled, "Roughness"), glossy.inputs["Roughness"])
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    connect(tree, source_of(principled, "Base Color"), diffuse.inputs["Color"])
    if principled["Normal"].is_linked:
        for node in (glossy, diffuse):
            tree.links.new(principled["Normal"].links[0].from_socket, node.inputs["Normal"])
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs[0].default_value = 1 if metallic else reflectance
    tree.links.new(diffuse.outputs[0], mix.inputs[1])
    tree.links.new(glossy.outputs[0], mix.inputs[2])
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(mix.outputs[0], output.inputs["Surface"])


def render(sky, picture_path, samples, width=160, height=90, bounces=0):
    scene = bpy.context.scene
    world = bpy.data.worlds.new("sky")
    scene.world = world
    world.use_nodes = True
    texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(sky)
    # The centre of the map is at -y of Blender, which the export makes +z.
    mapping = world.node_tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = (0, 0, math.radians(90))
    place = world.node_tree.nodes.new("ShaderNodeTexCoord")
    world.node_tree.links.new(place.outputs["Generated"], mapping.inputs["Vector"])
    world.node_tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    world.node_tree.links.new(texture.outputs["Color"], world.node_tree.nodes["Background"].inputs["Color"])
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.samples = samples
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = bounces
    cycles.caustics_reflective = True
    cycles.light_sampling_threshold = 0  # else dim light is dropped at random, for speed
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = picture_path
    bpy.ops.render.render(write_still=True)


def main():
    sky, glb, picture_path, *numbers = sys.argv[sys.argv.index("--") + 1 :]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    make_set()
    bpy.ops.export_scene.gltf(filepath=glb, export_cameras=True, export_tangents=True)
    add_reflectance(glb)
    for name, metallic, reflectance, _ in LOOKS:
        use_nodes_of_the_brdf(bpy.data.materials[name], metallic, reflectance)
    render(sky, picture_path, *map(int, numbers))


main()
