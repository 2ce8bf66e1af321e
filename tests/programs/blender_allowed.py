"""Whatever Blender lists for what is rendered is understood, or named: run in Blender, with the folder of scenes.

Usage: blender -b --factory-startup --python-exit-code 1 -P blender_allowed.py -- SCENES_FOLDER

All types of shader nodes that Blender has, with all their outputs, inputs and properties, and all properties of the data
that makes a picture: each is changed, and must then be in the allow-list, or be named.
"""

import sys

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, sys.argv[sys.argv.index("--") + 1])
from blender_export import allowed, differences  # noqa: E402
from blender_export.allowed import INPUTS, INSIDE, READ, Free  # noqa: E402
from blender_export.gltf_file import GltfFile  # noqa: E402
from blender_export.materials import SHARED, Materials  # noqa: E402
from blender_export.pictures import Pictures  # noqa: E402
from blender_export.report import Report  # noqa: E402

# Outputs that are read, by the types of their nodes. Of groups the nodes inside count.
OUTPUTS = {"ShaderNodeBsdfPrincipled": "*", "ShaderNodeBsdfDiffuse": "*", "ShaderNodeEmission": "*", "ShaderNodeRGB": "*",
           "ShaderNodeBsdfTransparent": "*",
           "ShaderNodeValue": "*", "ShaderNodeVertexColor": ("Color",), "ShaderNodeAttribute": ("Color",),
           "ShaderNodeTexImage": "*", "ShaderNodeSeparateColor": "*", "ShaderNodeSeparateRGB": "*"}
# Cannot be added to a tree, or do nothing there.
NO_NODES = {"ShaderNode", "ShaderNodeCustomGroup"}


def node_types():
    found = (getattr(bpy.types, name) for name in dir(bpy.types))
    return [kind for kind in found if isinstance(kind, type) and issubclass(kind, bpy.types.ShaderNode)
            and kind.__name__ not in NO_NODES]


def named(material):
    """What is left out of a material, but for what all of its kind have."""
    report, file = Report(), GltfFile()
    Materials(file, Pictures(file, report), report).find(material)
    return [entry for entry in report.entries() if not entry.startswith(SHARED)]


def fresh(kind):
    """A material with a Diffuse BSDF, and a node of a type in it."""
    material = bpy.data.materials.new("m")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    shader = tree.nodes.new("ShaderNodeBsdfDiffuse")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    node = output if kind == "ShaderNodeOutputMaterial" else tree.nodes.new(kind)
    if kind in ("ShaderNodeTexImage", "ShaderNodeTexEnvironment"):
        node.image = bpy.data.images.get("image") or bpy.data.images.new("image", 2, 2)
    return material, node, shader, output


def outputs():
    """Each output of each type, where colours and shaders are asked for."""
    count = 0
    for kind in node_types():
        material, node, shader, output = fresh(kind.__name__)
        for socket in node.outputs:
            if not socket.enabled:
                continue
            target = output.inputs["Surface"] if socket.type == "SHADER" else shader.inputs["Color"]
            link = material.node_tree.links.new(socket, target)
            found = named(material)
            understood = OUTPUTS.get(kind.__name__, ())
            expected = understood == "*" or socket.name in understood
            assert bool(found) != expected, "%s, output %s: %s" % (kind.__name__, socket.name, found)
            count += 1
            material.node_tree.links.remove(link)
            material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
        bpy.data.materials.remove(material)
    print("case outputs: %d" % count)


def other_values(item, rna):
    """Values of a property that are not its own."""
    value = differences.plain(getattr(item, rna.identifier))
    if rna.type == "ENUM" and not rna.is_enum_flag:
        return [other.identifier for other in rna.enum_items if other.identifier != value]
    if rna.type == "BOOLEAN":
        return [tuple(not v for v in value) if isinstance(value, tuple) else not value]
    if rna.type in ("INT", "FLOAT"):
        step = 1 if rna.type == "INT" else 0.25
        sides = [tuple(v + d for v in value) if isinstance(value, tuple) else value + d for d in (step, -step)]
        return sides
    if rna.type == "STRING":
        return ["other"]
    if rna.type == "POINTER" and rna.fixed_type.identifier in POINTED:
        return [POINTED[rna.fixed_type.identifier]()]
    return []


POINTED = {"Object": lambda: bpy.data.objects["Camera"], "Image": lambda: bpy.data.images.new("other", 2, 2),
           "Text": lambda: bpy.data.texts.new("other"), "Material": lambda: bpy.data.materials.new("other"),
           "Scene": lambda: bpy.data.scenes.new("other")}


def is_understood(rule, value):
    return isinstance(rule, Free) or rule is READ or rule is not None and value in rule


def properties_of(item, look):
    """Changes each property of an item: look() must then name one thing more, unless it is understood."""
    count = 0
    before = list(look())
    for rna in list(item.bl_rna.properties):
        rule = differences.rule_of(item.bl_rna, rna.identifier)
        if rule is INSIDE:
            count += properties_of(getattr(item, rna.identifier), look)
            continue
        if rna.is_readonly or isinstance(rule, Free) or rule is READ:
            continue
        own = getattr(item, rna.identifier)
        own = tuple(own) if hasattr(own, "__len__") and not isinstance(own, str) else own
        changed = False
        for value in other_values(item, rna):
            try:
                setattr(item, rna.identifier, value)
            except (TypeError, AttributeError, ValueError):
                continue
            now = differences.plain(getattr(item, rna.identifier))
            if now == own:
                continue
            changed = True
            count += 1
            if not is_understood(rule, now):
                assert len(list(look())) > len(before), "%s.%s is %s: it is not named" % (
                    item.bl_rna.identifier, rna.identifier, now)
        if changed:
            try:
                setattr(item, rna.identifier, own)
            except (TypeError, ValueError):  # an enum without a value
                pass
    return count


def inputs_of(node, look):
    """Changes each input of a node that is read."""
    count = 0
    rules = INPUTS[node.bl_idname]
    before = list(look())
    for socket in node.inputs:
        rule = rules.get(socket.identifier)
        if not socket.enabled or isinstance(rule, Free) or rule is READ:
            continue
        count += 1
        if hasattr(socket, "default_value"):
            own = differences.plain(socket.default_value)
            socket.default_value = tuple(v + 0.25 for v in own) if isinstance(own, tuple) else own + 0.25
            assert len(list(look())) > len(before), "%s, %s: its value is not named" % (node.bl_idname, socket.name)
            socket.default_value = own
        tree = node.id_data
        other = tree.nodes.new("ShaderNodeTexNoise")
        link = tree.links.new(other.outputs["Fac"], socket)
        assert len(list(look())) > len(before), "%s, %s: its link is not named" % (node.bl_idname, socket.name)
        tree.nodes.remove(other)
    return count


def nodes():
    """Of each type that is read: all properties and inputs."""
    count = 0
    for kind in INPUTS:
        if hasattr(bpy.types, kind):
            _, node, _, _ = fresh(kind) if kind not in ("ShaderNodeOutputWorld", "ShaderNodeBackground") else of_world(kind)
            look = lambda node=node: differences.node_differences(node)  # noqa: E731
            assert not list(look()), "%s, new: %s" % (kind, list(look()))
            count += properties_of(node, look) + inputs_of(node, look)
    print("case nodes: %d" % count)


def of_world(kind):
    world = bpy.data.worlds.new("w")
    world.use_nodes = True
    return world, next(n for n in world.node_tree.nodes if n.bl_idname == kind), None, None


def data():
    """All else that makes a picture."""
    bpy.ops.mesh.primitive_cube_add()
    thing, scene = bpy.context.object, bpy.context.scene
    camera = bpy.data.cameras.new("c")
    for item in (thing, thing.data, bpy.data.materials.new("d"), bpy.data.images.new("d", 2, 2), bpy.data.worlds.new("d"),
                 camera, bpy.context.view_layer, scene,
                 *(bpy.data.lights.new("l", kind) for kind in ("POINT", "SUN", "SPOT", "AREA"))):
        look = lambda item=item: differences.differences(item)  # noqa: E731
        assert not list(look()), "%s, new: %s" % (item.bl_rna.identifier, list(look()))
        print("case %s: %d" % (item.bl_rna.identifier, properties_of(item, look)))


def controls():
    """The same with a hole in the list: what is not listed is named, and what it lists is not."""
    _, node, _, _ = fresh("ShaderNodeBsdfPrincipled")
    look = lambda: list(differences.node_differences(node))  # noqa: E731
    rule = INPUTS["ShaderNodeBsdfPrincipled"].pop("Roughness")
    assert look() == ["Roughness"], look()
    INPUTS["ShaderNodeBsdfPrincipled"]["Roughness"] = rule
    rule = allowed.PROPERTIES["Object"].pop("pass_index")
    differences.KNOWN.clear()
    thing = bpy.data.objects["Camera"]
    thing.pass_index = 3
    assert len(list(differences.differences(thing))) == 1
    allowed.PROPERTIES["Object"]["pass_index"] = rule
    thing.pass_index = 0


for case in (outputs, nodes, data, controls):
    case()
print("all cases passed")
