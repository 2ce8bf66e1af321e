# SPDX-License-Identifier: GPL-3.0-or-later
"""What a set is made of, as hashes: equal if an export would be equal.

Reading the arrays of a mesh takes a fraction of the time of its export, and sees every change, whoever made it.
"""

import hashlib

import bpy
import numpy

from .blender_export import versions
from .blender_export.coordinates import STORED
from .blender_export.differences import differences
from .blender_export.gltf_export import passed_by_cycles
from .blender_export.lamps import name_differences
from .blender_export.report import Report
from .blender_export.shown import materials_of, walk, world_matrices
from .blender_export.triangles import read
from .session import stamp

# Of nodes and their sockets: where they are drawn.
DRAWN = {"rna_type", "location", "width", "height", "width_hidden", "select", "hide", "dimensions", "color",
         "use_custom_color", "show_options", "show_preview", "show_texture", "label", "parent", "bl_icon"}
READ_ABOVE = {"position", "material_index"}
OF_STRENGTH = {"energy", "color"}  # of a lamp
SIMPLE = {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}


def digest_of(*parts):
    """Of texts, bytes and arrays."""
    result = hashlib.blake2b(digest_size=16)
    for part in parts:
        result.update(part if isinstance(part, (bytes, numpy.ndarray)) else str(part).encode())
        result.update(b"\0")
    return result.hexdigest()


def values_of(item):
    """Settings of a node or socket, in a fixed order; images by their content."""
    found = []
    for name, rna in sorted(item.bl_rna.properties.items()):
        if name in DRAWN:
            continue
        if rna.type in SIMPLE and not rna.is_hidden:
            value = getattr(item, name)
            found.append((name, tuple(value) if getattr(rna, "is_array", False) else value))
        elif isinstance(rna, bpy.types.PointerProperty):
            value = getattr(item, name)
            if isinstance(value, bpy.types.Image):
                found.append((name, image_of(value)))
            elif isinstance(value, bpy.types.ColorRamp):
                found.append((name, value.interpolation, [(e.position, *e.color) for e in value.elements]))
            elif isinstance(value, bpy.types.CurveMapping):
                value.initialize()
                found.append((name, [value.evaluate(c, i / 32) for c in value.curves for i in range(33)]))
            elif isinstance(value, bpy.types.ImageUser):
                found.append((name, value.frame_current, value.frame_offset, value.frame_start))
            elif isinstance(value, (bpy.types.TexMapping, bpy.types.ColorMapping)):
                found.append((name, values_of(value)))
            elif isinstance(value, bpy.types.ID) and not isinstance(value, bpy.types.NodeTree):
                found.append((name, value.name_full))
    return found


def image_of(image):
    settings = image.name_full, image.source, image.colorspace_settings.name, image.alpha_mode, tuple(image.size)
    if image.source == "GENERATED" or image.is_dirty:
        texels = numpy.empty(len(image.pixels), numpy.float32)
        image.pixels.foreach_get(texels)
        return *settings, digest_of(texels)
    if image.packed_file:
        return *settings, digest_of(image.packed_file.data)
    return *settings, stamp(bpy.path.abspath(image.filepath, library=image.library))


def nodes_of(tree, depth=0):
    """All of a node tree that may change what it makes, as a text."""
    if tree is None:
        return ""
    found = []
    for node in tree.nodes:
        inner = nodes_of(node.node_tree, depth + 1) if getattr(node, "node_tree", None) and depth < 8 else ""
        sockets = [(s.identifier, values_of(s)) for s in (*node.inputs, *node.outputs) if hasattr(s, "default_value")]
        found.append((node.name, values_of(node), sockets, inner))
    found.append([(l.from_node.name, l.from_socket.identifier, l.to_node.name, l.to_socket.identifier, l.is_muted)
                  for l in tree.links])
    return repr(found)


def material_digest(material):
    if material is None:
        return ""
    return digest_of(material.name, bool(versions.setting_of(material, "use_transparent_shadow")), material.use_nodes,
                     tuple(material.diffuse_color), list(differences(material)),
                     nodes_of(material.node_tree) if material.use_nodes else "")


def mesh_digest(mesh):
    arrays = [read(mesh.vertices, "co", 3, numpy.float32), read(mesh.loops, "vertex_index", 1, numpy.int32)]
    for name, kind in (("loop_total", numpy.int32), ("material_index", numpy.int32), ("use_smooth", bool)):
        arrays.append(read(mesh.polygons, name, 1, kind))
    if versions.splits_normals(mesh):
        arrays += [read(mesh.edges, "use_edge_sharp", 1, bool), read(mesh.edges, "vertices", 2, numpy.int32)]
        if mesh.has_custom_normals:
            arrays.append(versions.corner_normals(mesh))
    texts = [mesh.name, versions.splits_normals(mesh), versions.smooth_angle(mesh)]
    for layer in mesh.uv_layers:
        texts += [layer.name, layer.active_render]
        arrays.append(read(layer.data, "uv", 2, numpy.float32))
    for layer in mesh.attributes:
        if layer.data_type in STORED and layer.name not in READ_ABOVE:
            texts += [layer.name, layer.domain, layer.data_type]
            arrays.append(read(layer.data, *STORED[layer.data_type]))
    texts += [mesh.color_attributes.render_color_index, tuple(mesh.texspace_location), tuple(mesh.texspace_size),
              list(differences(mesh))]
    return digest_of(texts, *arrays)


def lamp_digest(thing):
    """Of all but the strength."""
    lamp = thing.data
    settings = [value for value in values_of(lamp) if value[0] not in OF_STRENGTH]
    return digest_of(thing.name, thing.visible_camera, settings, values_of(lamp.cycles), nodes_of(lamp.node_tree) if lamp.use_nodes else "")


def strength_of(lamp):
    """To which the lamp's light is in proportion, by colour."""
    return [lamp.energy * c for c in lamp.color]


class Strengths:
    """Of lamps by name, as far as a gain by name can change them; the digest is of the others."""

    def __init__(self):
        self.found, self.fixed = {}, []

    def add(self, thing):
        now = strength_of(thing.data)
        if "*" in thing.name or min(now) < 0 or self.found.setdefault(thing.name, now) != now:
            self.fixed.append((thing.name, now))

    def by_name(self, materials):
        """materials: names that gains would change as well."""
        fixed = materials.union(name for name, _ in self.fixed)
        return {name: now for name, now in self.found.items() if name not in fixed}

    def digest(self, dimmable):
        return digest_of(self.fixed, [(name, now) for name, now in self.found.items() if name not in dimmable])


def content_of(depsgraph, report):
    """A digest of the meshes, materials and lamps that are shown, instance by instance; not of where they are, nor of the
    strengths of lamps by name, which are beside it. Adds to the report what of objects and lamps is not exported."""
    meshes, materials, known, found, strengths, names = {}, {}, {}, [], Strengths(), set()
    for shown in walk(depsgraph, report):
        if shown.kind == "LIGHT":
            name_differences(shown.thing, report)
            found.append((shown.row, lamp_digest(shown.thing)))
            strengths.add(shown.thing)
        if shown.kind != "MESH":
            continue
        if shown.key not in known:
            data = shown.thing.data
            if data.as_pointer() not in meshes:
                meshes[data.as_pointer()] = mesh_digest(data)
            looks = []
            for material in materials_of(shown.thing, depsgraph):
                name = material.name_full if material else ""
                names.add(material.name if material else "")
                if name not in materials:
                    materials[name] = material_digest(material)
                looks.append(materials[name])
            known[shown.key] = digest_of(meshes[data.as_pointer()], looks)
        found.append((shown.row, known[shown.key]))
    by_name = strengths.by_name(names)
    return digest_of(found, strengths.digest(by_name), passed_by_cycles(depsgraph.scene)), by_name


def places_digest(matrices, rows):
    return digest_of(numpy.ascontiguousarray(matrices[rows]))


def mesh_rows(depsgraph):
    """Of all instances, those that are no camera."""
    return [row for row, instance in enumerate(depsgraph.object_instances) if instance.object.type != "CAMERA"]


def current_places(depsgraph):
    return places_digest(world_matrices(depsgraph), mesh_rows(depsgraph))


class State:
    """What is shown in the current frame, where it is, and how strong lamps are; what of the objects is left out, which an
    export does not change. panes: whether light is to pass glass."""

    def __init__(self, depsgraph, panes=True):
        report = Report()
        self.panes = panes
        self.content, self.strengths = content_of(depsgraph, report)
        if not panes:
            self.content = digest_of(self.content, "without panes")
        self.left_out = report.entries()
        self.places = current_places(depsgraph)
