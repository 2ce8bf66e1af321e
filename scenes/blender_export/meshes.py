"""Meshes of a glTF document from Blender's evaluated meshes."""

import hashlib
from collections import Counter

import numpy

from .coordinates import layer_of, texture_places, unread_of
from .differences import differences
from .triangles import MeshArrays, read, share
from .versions import corner_normals


# Of all meshes of a kind, in one entry.
COARSE = "Smooth shading of coarse facets: rays start on the smooth surface; beside Cycles, light from the side differs"
MOST_BENT = 0.01  # mean of (1 - cos) / 2 of the angles from facets to their corners' normals; 1 % of a white sky
LOOKED_AT = 20000  # triangles


def y_up(vectors):
    """Blender's +Z up to glTF's +Y up, of rows."""
    turned = numpy.empty_like(vectors)
    turned[:, 0], turned[:, 1], turned[:, 2] = vectors[:, 0], vectors[:, 2], -vectors[:, 1]
    return turned


def material_numbers(mesh):
    """The slot of each polygon. The attribute is read in one piece, the property of polygons one by one."""
    attribute = mesh.attributes.get("material_index")
    if attribute is None:
        return numpy.zeros(len(mesh.polygons), numpy.int32)
    return read(attribute.data, "value", 1, numpy.int32)


def vertex_colours(mesh, look, vertex_of):
    """Linear colour and opacity of the loops as a look has them of the mesh; black where it has no such colours, as in
    Cycles."""
    colours = mesh.color_attributes
    active = colours[colours.render_color_index].name if len(colours) else ""
    result = numpy.ones((len(vertex_of), 4), numpy.float32)
    for name, columns in ((look.tint, slice(0, 3)), (look.fade, slice(3, 4))):
        if name is not None:
            result[:, columns] = layer_of(mesh, name or active, vertex_of)[:, columns]
    return result


def bend_of(part, indices):
    """How far the normals of corners are from those of their triangles, by MOST_BENT's measure, weighted by area."""
    triangles = indices.reshape(-1, 3)
    triangles = triangles[::max(len(triangles) // LOOKED_AT, 1)]
    a, b, c = (part["POSITION"][triangles[:, k]].astype(float) for k in range(3))
    across = numpy.cross(b - a, c - a)
    cosines = numpy.einsum("ijk,ik->ij", part["NORMAL"][triangles].astype(float), across)
    area = numpy.linalg.norm(across, axis=1).sum()
    return (1 - numpy.abs(cosines).mean(axis=1).sum() / area) / 2 if area > 0 else 0


class MeshWriter:
    """Writes each mesh once, however many objects show it."""

    def __init__(self, file, materials, report):
        self.file = file
        self.materials = materials
        self.report = report
        self.by_content = {}
        self.passed = {}  # by the numbers of meshes: polygons that rays pass, by the names of their materials

    def write(self, name, mesh, slots):
        """The number of a mesh with a material (or None) for each slot; None if it has no triangle."""
        arrays = MeshArrays(mesh)
        for text in (*differences(mesh), *arrays.left_out()):
            self.report.add("mesh %s: %s" % (mesh.name, text))
        if not len(arrays.corners):
            return None
        smooth = read(mesh.polygons, "use_smooth", 1, bool)
        normals = corner_normals(mesh)
        if mesh.has_custom_normals and normals is not None:
            smooth[:] = True
        slot = numpy.clip(material_numbers(mesh), 0, max(len(slots) - 1, 0))
        parts = [self._part(mesh, arrays, corners, slots[k // 2] if slots else None, normals, bool(k % 2))
                 for k, corners in self._groups(arrays, 2 * slot + smooth)]
        number = self._once(name, parts)
        self.passed[number] = self._passed_by(slot, slots)
        return number

    def _passed_by(self, slot, slots):
        """How many polygons rays pass straight on, by the names of their materials."""
        found = Counter()
        for material, count in zip(slots, numpy.bincount(slot, minlength=len(slots))):
            if count and self.materials.find(material).passes:
                found[material.name] += int(count)
        return found

    @staticmethod
    def _groups(arrays, group_of_polygon):
        """Corners by slot and by whether they are smooth: what is flat needs no normals, and shares its vertices."""
        if (group_of_polygon == group_of_polygon[0]).all():
            return [(int(group_of_polygon[0]), arrays.corners)]
        group = group_of_polygon[arrays.polygon_of]
        return [(int(k), arrays.corners[group == k]) for k in numpy.unique(group)]

    def _part(self, mesh, arrays, corners, material, normals, smooth):
        """Arrays of a primitive by attribute, with its indices and the number of its material."""
        look = self.materials.find(material)
        for name in filter(None, (look.tint, look.fade, *(where.name for where in look.maps))):
            if unread_of(mesh, name):
                self.report.add("mesh %s: %s" % (mesh.name, unread_of(mesh, name)))
        layers = {"TEXCOORD_%d" % i: texture_places(mesh, where, arrays.vertex_of) for i, where in enumerate(look.maps)}
        if (look.tint, look.fade) != (None, None):
            colours = layers["COLOR_0"] = vertex_colours(mesh, look, arrays.vertex_of)
            if colours.min() < 0 or colours.max() > 1:
                self.report.add("mesh %s: colours below 0 or above 1" % mesh.name)
        if smooth and normals is not None:
            layers["NORMAL"] = normals
        loops, indices = share(corners, arrays.vertex_of, list(layers.values()), len(arrays.places))
        vertices = arrays.vertex_of[loops]
        part = {name: layer[loops] for name, layer in layers.items()}
        if smooth and normals is None:
            part["NORMAL"] = read(mesh.vertex_normals, "vector", 3, numpy.float32)[vertices]
        if "NORMAL" in part:
            part["NORMAL"] = y_up(part["NORMAL"])
        part["POSITION"] = y_up(arrays.places[vertices])
        if "NORMAL" in part and bend_of(part, indices) > MOST_BENT:
            self.report.share(COARSE, mesh.name)
        return part, indices, look.number

    def _once(self, name, parts):
        """Meshes that Blender evaluated for each object, because of modifiers, are often equal."""
        content = hashlib.blake2b(digest_size=16)
        for part, indices, material in parts:
            content.update(repr((sorted(part), material, len(indices))).encode())
            for key in sorted(part):
                content.update(part[key])
            content.update(indices)
        key = content.digest()
        if key not in self.by_content:
            self.by_content[key] = self.file.add("meshes", {
                "name": name, "primitives": [self._primitive(*part) for part in parts]})
        return self.by_content[key]

    def _primitive(self, part, indices, material):
        primitive = {"attributes": {name: self.file.add_accessor(values, bounds=name == "POSITION")
                                    for name, values in part.items()},
                     "indices": self.file.add_accessor(indices), "material": material}
        return primitive
