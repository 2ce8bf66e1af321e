"""Renders a shot with Cycles, inside Blender: blender -b --factory-startup --python in_blender.py -- REQUEST.json

REQUEST.json: files, up ("y" or "z") and scale of the set; map and rotate [degrees]; camera (origin, forward, up, fov); size
[width, height], albedo of what has no material, bounces, threads; renders, a list of samples, seed and picture (.exr); stats,
a JSON file that gets load_seconds, from the start of the process to a first picture of one sample, and seconds of each
render, without what a picture of one sample takes but for its sample. Seconds are of the processor.
"""
import json
import math
import resource
import sys

import bpy
from mathutils import Matrix, Vector

FORMATS = {".obj": lambda path: bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z"),
           ".ply": lambda path: bpy.ops.import_mesh.ply(filepath=path),
           ".stl": lambda path: bpy.ops.import_mesh.stl(filepath=path, axis_forward="Y", axis_up="Z")}
Y_UP = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))  # +Y up to Blender's +Z up
MIDDLE = 90.0  # degrees about +Z from where our map's middle is then to where Cycles has it


def import_gltf(path):
    import numpy
    if not hasattr(numpy, "bool"):  # the importer of Blender 3.4 takes it from an older NumPy
        numpy.bool = bool
    bpy.ops.import_scene.gltf(filepath=path)


def add_set(files, up, scale, albedo):
    for path in files:
        extension = path[path.rfind("."):].lower()
        before = set(bpy.data.objects)
        if extension in (".gltf", ".glb"):
            import_gltf(path)
            to_world = Matrix()
        else:
            FORMATS[extension](path)
            to_world = Y_UP if up == "y" else Matrix()
        for thing in set(bpy.data.objects) - before:
            if thing.parent is None:
                thing.matrix_world = Matrix.Scale(scale, 4) @ to_world @ thing.matrix_world
    for light in [thing for thing in bpy.data.objects if thing.type == "LIGHT"]:
        bpy.data.objects.remove(light)
    for material in list(bpy.data.materials):
        use_nodes_of_the_brdf(material)
    plain = new_material("plain")
    plain.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (albedo, albedo, albedo, 1)
    for thing in bpy.data.objects:
        if thing.type == "MESH" and not any(thing.data.materials):
            thing.data.materials.clear()
            thing.data.materials.append(material_of_colours(thing.data) or plain)
    use_nodes_of_the_brdf(plain, reflectance=0)


def new_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    return material


def material_of_colours(mesh):
    """Diffuse, of the colours at the vertices; None where it has none."""
    if not mesh.color_attributes:
        return None
    material = new_material("colours")
    tree = material.node_tree
    colours = tree.nodes.new("ShaderNodeVertexColor")
    colours.layer_name = mesh.color_attributes[0].name
    tree.links.new(colours.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    use_nodes_of_the_brdf(material, reflectance=0)
    return material


def connect(tree, source, target):
    """As `source`, an input of another node, is fed."""
    if source.is_linked:
        tree.links.new(source.links[0].from_socket, target)
    else:
        target.default_value = source.default_value


def reflectance_of(tree):
    """Factor of what a dielectric reflects, KHR_materials_specular."""
    groups = (node.inputs.get("Specular") for node in tree.nodes if node.type == "GROUP")
    return next((socket.default_value for socket in groups if socket), 1.0)


def node_of(tree, kind, **inputs):
    """A new node, its inputs fed as others are, or with values."""
    node = tree.nodes.new(kind)
    for name, source in inputs.items():
        socket = node.inputs[int(name[1:]) if name[0] == "_" else name]
        if isinstance(source, bpy.types.NodeSocket) and source.is_output:
            tree.links.new(source, socket)
        elif isinstance(source, bpy.types.NodeSocket):
            connect(tree, source, socket)
        else:
            socket.default_value = source
    return node.outputs[0]


def use_nodes_of_the_brdf(material, reflectance=None):
    """Lambert and GGX, as glTF specifies it, in place of the Principled BSDF, whose diffuse part is another one."""
    tree = material.node_tree
    principled = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None) if tree else None
    if not principled:
        return
    inputs = principled.inputs
    reflectance = reflectance_of(tree) if reflectance is None else reflectance
    shader = node_of(tree, "ShaderNodeBsdfDiffuse", Color=inputs["Base Color"], Normal=inputs["Normal"])
    if reflectance > 0:
        gloss = node_of(tree, "ShaderNodeBsdfGlossy", Color=(1, 1, 1, 1), Roughness=inputs["Roughness"], Normal=inputs["Normal"])
        share = node_of(tree, "ShaderNodeFresnel", IOR=inputs["IOR"], Normal=inputs["Normal"])
        share = times(tree, share, reflectance)
        shader = node_of(tree, "ShaderNodeMixShader", _0=share, _1=shader, _2=gloss)
    metallic = inputs["Metallic"]
    if metallic.is_linked or metallic.default_value > 0:
        metal = node_of(tree, "ShaderNodeBsdfGlossy", Color=inputs["Base Color"], Roughness=inputs["Roughness"],
                        Normal=inputs["Normal"])
        shader = node_of(tree, "ShaderNodeMixShader", _0=metallic, _1=shader, _2=metal)
    alpha = inputs["Alpha"]
    if alpha.is_linked or alpha.default_value < 1:
        shader = node_of(tree, "ShaderNodeMixShader", _0=alpha, _1=node_of(tree, "ShaderNodeBsdfTransparent"), _2=shader)
    for node in tree.nodes:
        if node.type == "BSDF_GLOSSY":
            node.distribution = "GGX"
    tree.links.new(shader, tree.get_output_node("CYCLES").inputs["Surface"])


def times(tree, output, factor):
    node = tree.nodes.new("ShaderNodeMath")
    node.operation = "MULTIPLY"
    tree.links.new(output, node.inputs[0])
    node.inputs[1].default_value = factor
    return node.outputs[0]


def axes_of(forward, up):
    """Right, up and back of a camera, the columns of a rotation; `forward` and `up` have any length, and any angle but 0."""
    forward = forward.normalized()
    right = forward.cross(up).normalized()
    return Matrix((right, right.cross(forward), -forward)).transposed().to_4x4()


def add_camera(pose):
    axes = axes_of(Y_UP @ Vector(pose["forward"]), Y_UP @ Vector(pose["up"]))
    axes.translation = Y_UP @ Vector(pose["origin"])
    camera = bpy.data.cameras.new("measured")
    camera.sensor_fit = "VERTICAL"
    camera.angle = math.radians(pose["fov"])
    camera.clip_start, camera.clip_end = 1e-4, 1e9
    thing = bpy.data.objects.new("measured", camera)
    thing.matrix_world = axes
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.scene.camera = thing


def add_sky(path, rotate):
    """The map, turned by `rotate` degrees counter-clockwise seen from above."""
    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    world.use_nodes = True
    tree = world.node_tree
    turn = tree.nodes.new("ShaderNodeMapping")
    turn.inputs["Rotation"].default_value = (0, 0, math.radians(MIDDLE - rotate))
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"], turn.inputs["Vector"])
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = bpy.data.images.load(path)
    texture.image.colorspace_settings.name = "Linear"
    tree.links.new(turn.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def choose_settings(request):
    """Of the size, threads and bounces, without what makes pictures another one for speed."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.use_persistent_data = True
    scene.render.threads_mode = "FIXED"
    scene.render.threads = request["threads"]
    scene.render.resolution_x, scene.render.resolution_y = request["size"]
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = request["bounces"]
    cycles.light_sampling_threshold = 0  # else dim light is dropped at random, for speed
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    cycles.filter_width = 1.5


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def render(picture, samples, seed):
    """Processor seconds."""
    scene = bpy.context.scene
    scene.cycles.samples = samples
    scene.cycles.seed = seed
    scene.render.filepath = picture
    before = processor_seconds()
    bpy.ops.render.render(write_still=True)
    return processor_seconds() - before


def main():
    with open(sys.argv[sys.argv.index("--") + 1], encoding="utf-8") as file:
        request = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    add_set(request["files"], request["up"], request["scale"], request["albedo"])
    add_camera(request["camera"])
    add_sky(request["map"], request["rotate"])
    choose_settings(request)
    renders = request["renders"]
    render(renders[0]["picture"], 1, 0)
    load = processor_seconds()
    least = min(render(renders[0]["picture"], 1, 0) for _ in range(2))
    seconds = []
    for wanted in renders:
        samples = wanted["samples"]
        spent = render(wanted["picture"], samples, wanted["seed"])
        seconds.append(max(0.0, spent - least) * samples / max(1, samples - 1))
    with open(request["stats"], "w", encoding="utf-8") as file:
        json.dump({"load_seconds": load, "seconds": seconds}, file)


if __name__ == "__main__":
    main()
