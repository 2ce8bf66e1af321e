# SPDX-License-Identifier: GPL-3.0-or-later
"""What a hybrid needs of Cycles for a scene to be right; what cannot be right is refused by name.

Where a material is not exported as it is, its direct light is that of Cycles. That is right as long as the exported
surface casts the same shadows. Where a lamp or what a material emits is not, or an emitter moves, the direct light of all
lamps and emitters is.
"""

from dataclasses import dataclass

import bpy

from . import shining, world
from .blender_export import versions
from .blender_export.lamps import THROUGH_GLASS
from .blender_export.materials import SHARED
from .blender_export.meshes import COARSE
from .blender_export.node_values import source
from .blender_export.shown import other_layers

# Nodes through which light goes straight, which an exported stand-in would stop.
SEE_THROUGH = {"BSDF_TRANSPARENT", "HOLDOUT", "SCRIPT"}
# Entries that are no reason for Cycles, or of what it shows in any case.
OF_NONE = (THROUGH_GLASS, *SHARED, COARSE)


@dataclass(frozen=True)
class Needs:
    masked: tuple     # names of materials whose direct light is Cycles'
    lamps: tuple      # lamps and emitters not exported as they are; emitters that move, which light nothing directly


def needs_of(depsgraph, entries, path):
    """Needs of a depsgraph of a render, whose set's file is at `path` and has left out `entries`. Raises ValueError with all reasons
    why a hybrid would be wrong."""
    materials = [item for item in depsgraph.ids if isinstance(item, bpy.types.Material)]
    refused, masked, lamps = of_scene(depsgraph), {}, []
    for entry in entries:
        if entry.startswith(OF_NONE):
            continue
        if entry.startswith("light "):
            lamps.append(entry)
            continue
        owners = [m for m in materials if is_about(entry, m)]
        masked.update((m.name, None) for m in owners)
        if not owners or not all(has_exported_shadow(m, entry) for m in owners):
            refused.append(entry)
    refused += ["material %s: a comma in its name" % name for name in masked if "," in name]
    if refused:
        raise ValueError("a hybrid would be wrong: " + "; ".join(refused))
    lamps += ["material " + m.name for m in materials if m.name in masked and emits(m)]
    lamps += ["material %s: emits and moves" % name for name in shining.moving(path)]
    return Needs(tuple(sorted(masked)), tuple(lamps))


def of_scene(depsgraph):
    """What is wrong with the scene itself."""
    scene = depsgraph.scene
    found = ["view layer %s: expected one" % name for name in other_layers(depsgraph)]
    if depsgraph.view_layer.material_override:
        found.append("view layer %s: material override" % depsgraph.view_layer.name)
    if scene.render.use_motion_blur:
        found.append("motion blur")
    if scene.render.use_multiview:
        found.append("stereoscopy")
    if scene.background_set:
        found.append("background set %s" % scene.background_set.name)
    if scene.world and scene.world.use_nodes:
        found += world.left_out(scene.world, False)
        output = scene.world.node_tree.get_output_node("CYCLES")
        if output and source(output.inputs["Volume"]):
            found.append("world %s: Volume" % scene.world.name)
    return found


def is_about(entry, material):
    """Whether an entry of the export concerns a material: itself, or an image of it."""
    if entry.startswith("material %s: " % material.name):
        return True
    return any(node.type == "TEX_IMAGE" and node.image and entry.startswith("image %s: " % node.image.name)
               for node in nodes_of(material))


def nodes_of(material):
    return world.nodes_in(material.node_tree) if material.use_nodes else ()


def has_exported_shadow(material, entry):
    """Whether a material that is not exported as it is stops light as the exported one does."""
    if not material.use_nodes:
        return True
    output = material.node_tree.get_output_node("CYCLES")
    if not output or not source(output.inputs["Surface"]) or source(output.inputs["Volume"]):
        return False
    if source(output.inputs["Displacement"]) and versions.setting_of(material, "displacement_method") != "BUMP":
        return False
    nodes = list(nodes_of(material))
    if any(node.type in SEE_THROUGH for node in nodes):
        return False
    shaders = [node for node in nodes if node.type == "BSDF_PRINCIPLED"]
    if not any(source(node.inputs["Alpha"]) or node.inputs["Alpha"].default_value < 1 for node in shaders):
        return True
    # It has holes. They are those of the export if what is left out is not about them.
    is_exported = source(output.inputs["Surface"]).node.type == "BSDF_PRINCIPLED"
    of_holes = ("material %s: %s" % (material.name, words) for words in ("Alpha", "image "))
    return is_exported and not entry.startswith(("image ", *of_holes))


def emits(material):
    """Whether a material may emit."""
    for node in nodes_of(material):
        if node.type in ("EMISSION", "SCRIPT"):
            return True
        if node.type == "BSDF_PRINCIPLED":
            colour, strength = versions.principled_input(node, "Emission"), node.inputs["Emission Strength"]
            if (source(strength) or strength.default_value) and (source(colour) or any(colour.default_value[:3])):
                return True
    return False
