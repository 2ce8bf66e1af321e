# SPDX-License-Identifier: GPL-3.0-or-later
"""The compositor's nodes of a hybrid: Cycles' picture, with this engine's direct light in place of its own.

Direct light is the product of passes. Where that of lamps is Cycles', it is the product of those of the scene with lamps
alone, else black:

    Image = Cycles + (Own + Lamps - Direct of Cycles)

The bracket counts where no material of the pixel is masked.
"""

import bpy

from .blender_export.versions import add_socket

NAME = "Shadowcache Hybrid"   # of the group, and of what belongs to it in a tree
PARTS = (("Diff", "DiffDir", "DiffCol"), ("Gloss", "GlossDir", "GlossCol"))
BLACK = (0, 0, 0, 1)
LEAST_COVERAGE = 1e-6  # of masked materials in a pixel


def sockets(prefix):
    return [prefix + name for _, direct, colour in PARTS for name in (direct, colour)]


OWN, CYCLES, LAMPS = "", "Cycles ", "Lamps "
INPUTS = ["Cycles", *sockets(OWN), *sockets(CYCLES), *sockets(LAMPS)]


def group():
    """The node group, made anew unless it is there."""
    found = bpy.data.node_groups.get(NAME)
    if found:
        return found
    found = bpy.data.node_groups.new(NAME, "CompositorNodeTree")
    for name in INPUTS:
        add_socket(found, "NodeSocketColor", name).default_value = BLACK
    add_socket(found, "NodeSocketFloat", "Masked")
    add_socket(found, "NodeSocketColor", "Image", is_output=True)
    build(found)
    return found


def build(tree):
    first = tree.nodes.new("NodeGroupInput")
    last = tree.nodes.new("NodeGroupOutput")
    first.location, last.location = (-600, 0), (600, 0)

    def mix(kind, a, b, x, y):
        node = tree.nodes.new("CompositorNodeMixRGB")
        node.blend_type, node.location = kind, (x, y)
        tree.links.new(a, node.inputs[1])
        tree.links.new(b, node.inputs[2])
        return node

    def direct(prefix, y):
        parts = [mix("MULTIPLY", *(first.outputs[prefix + name] for name in names), -400, y - 150 * i).outputs[0]
                 for i, (_, *names) in enumerate(PARTS)]
        return mix("ADD", *parts, -200, y).outputs[0]

    light = mix("ADD", direct(OWN, 400), direct(LAMPS, 0), 0, 200)
    change = mix("SUBTRACT", light.outputs[0], direct(CYCLES, -400), 200, 0)
    whole = mix("ADD", first.outputs["Cycles"], change.outputs[0], 400, 0)  # with the alpha of the first
    own = tree.nodes.new("CompositorNodeMath")
    own.operation, own.location = "LESS_THAN", (200, 200)
    own.inputs[1].default_value = LEAST_COVERAGE
    tree.links.new(first.outputs["Masked"], own.inputs[0])
    tree.links.new(own.outputs[0], whole.inputs[0])
    tree.links.new(whole.outputs[0], last.inputs[0])


def own_nodes(tree):
    return [node for node in tree.nodes if node.name.startswith(NAME)]


def group_node(tree):
    """Of a tree; None without a hybrid."""
    return next((n for n in own_nodes(tree) if n.type == "GROUP" and n.node_tree and not n.mute), None)


def masked(tree):
    """Names of the materials whose direct light is Cycles'."""
    node = tree.nodes.get(NAME + " Masked")
    return {name.strip() for name in node.matte_id.split(",")} if node else set()


def make(scene, layer, rest, lamps, masks):
    """Makes the nodes in a scene's tree, and feeds by them what its picture fed."""
    if not scene.node_tree:
        scene.use_nodes = True  # with a picture and an output
    scene.use_nodes = scene.render.use_compositing = True
    tree = scene.node_tree
    remove(tree)
    node = add(tree, "CompositorNodeGroup", "", 0, 0)
    node.node_tree, node.width = group(), 200
    places = ((OWN, scene, layer), (CYCLES, rest, rest.view_layers[0].name),
              (LAMPS, lamps, lamps and lamps.view_layers[0].name))
    for i, (prefix, of, name) in enumerate(places):
        if of:
            passes = add(tree, "CompositorNodeRLayers", " %s" % of.name, -400, 400 - 300 * i)
            passes.scene, passes.layer = of, name
            for socket in sockets(prefix):
                tree.links.new(passes.outputs[socket[len(prefix):]], node.inputs[socket])
            if of == rest:
                tree.links.new(passes.outputs["Image"], node.inputs["Cycles"])
    if masks:
        matte = add(tree, "CompositorNodeCryptomatteV2", " Masked", -400, -500)
        matte.scene, matte.matte_id = rest, ",".join(masks)
        tree.links.new(matte.outputs["Matte"], node.inputs["Masked"])
    for link in pictures(tree, scene):
        tree.links.new(node.outputs["Image"], link.to_socket)
    if not node.outputs["Image"].is_linked:
        output = next((n for n in tree.nodes if n.type == "COMPOSITE"), None)
        output = output or tree.nodes.new("CompositorNodeComposite")
        if not output.inputs[0].is_linked:
            tree.links.new(node.outputs["Image"], output.inputs[0])


def add(tree, kind, words, x, y):
    """A node that belongs to the hybrid, below those of the user."""
    node = tree.nodes.new(kind)
    node.name = node.label = NAME + words
    node.show_preview = False  # lower
    lowest = min((n.location.y for n in tree.nodes if n not in own_nodes(tree)), default=0)
    node.location = x, lowest - 850 + y
    return node


def pictures(tree, scene):
    """Links from the pictures of a scene's renders."""
    own = own_nodes(tree)
    return [link for link in tree.links if link.from_node.type == "R_LAYERS" and link.from_node.scene == scene
            and link.from_socket.name == "Image" and link.from_node not in own]


def remove(tree):
    """Feeds by the picture of the scene's render what the nodes fed, and removes them."""
    node = next((n for n in own_nodes(tree) if n.type == "GROUP"), None)
    own = own_nodes(tree)
    users = [n for n in tree.nodes if n.type == "R_LAYERS" and n not in own]
    source = next((n for n in users if n.scene and n.scene.node_tree == tree), None)
    if node and source:
        for link in list(node.outputs[0].links):
            tree.links.new(source.outputs["Image"], link.to_socket)
    for item in own:
        tree.nodes.remove(item)
    found = bpy.data.node_groups.get(NAME)
    if found and not found.users:
        bpy.data.node_groups.remove(found)
