# SPDX-License-Identifier: GPL-3.0-or-later
"""What shines in a set's file."""

import json
import struct


def document_of(path):
    """The document of a .glb file."""
    with open(path, "rb") as file:
        length, = struct.unpack_from("<I", file.read(20), 12)
        return json.loads(file.read(length))


def emits(material):
    """Whether a material of a document does."""
    return any(material.get("emissiveFactor", ())) or "KHR_materials_unlit" in material.get("extensions", {})


def names(path):
    """Names of all that shines: lamps, and materials that emit."""
    document = document_of(path)
    lamps = {node.get("name", "") for node in document.get("nodes", ())
             if "KHR_lights_punctual" in node.get("extensions", {})}
    return lamps | {material.get("name", "") for material in document.get("materials", ()) if emits(material)}


def moving(path):
    """Names of materials that emit and are of a mesh that moves."""
    document = document_of(path)
    nodes, meshes, materials = (document.get(key, ()) for key in ("nodes", "meshes", "materials"))
    tops = {channel["target"]["node"] for animation in document.get("animations", ()) for channel in animation["channels"]}
    moved = [nodes[number] for top in tops for number in (top, *nodes[top].get("children", ()))]
    used = {primitive["material"] for node in moved if "mesh" in node
            for primitive in meshes[node["mesh"]]["primitives"] if "material" in primitive}
    return sorted(materials[number].get("name", "") for number in used if emits(materials[number]))
