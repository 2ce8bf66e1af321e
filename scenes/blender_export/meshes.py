"""Meshes of a glTF document from Blender's evaluated meshes."""

import hashlib

import numpy

from .triangles import MeshArrays, read, share
from .versions import corner_normals


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


def texture_places(mesh, name):
    """Coordinates of the loops, t downwards as glTF has it; a missing map is 0 everywhere, as in Blender."""
    layer = mesh.uv_layers.get(name) if name else next((u for u in mesh.uv_layers if u.active_render), None)
    attribute = mesh.attributes.get(name) if name else None
    if layer is not None:
        places = read(layer.data, "uv", 2, numpy.float32)
    elif attribute is not None and attribute.data_type == "FLOAT2" and attribute.domain == "CORNER":
        places = read(attribute.data, "vector", 2, numpy.float32)
    else:
        places = numpy.zeros((len(mesh.loops), 2), numpy.float32)
    places[:, 1] = 1 - places[:, 1]
    return places


def vertex_colours(mesh, name, vertex_of):
    """Linear colour and opacity of the loops; None if the mesh has no such colours."""
    colours = mesh.color_attributes
    attribute = colours.get(name) if name else (colours[colours.render_color_index] if len(colours) else None)
    if attribute is None or attribute.domain not in ("POINT", "CORNER"):
        return None
    values = read(attribute.data, "color", 4, numpy.float32)
    return values[vertex_of] if attribute.domain == "POINT" else values


class MeshWriter:
    """Writes each mesh once, however many objects show it."""

    def __init__(self, file, materials, report):
        self.file = file
        self.materials = materials
        self.report = report
        self.by_content = {}

    def write(self, name, mesh, slots):
        """The number of a mesh with a material (or None) for each slot; None if it has no triangle."""
        arrays = MeshArrays(mesh)
        if not len(arrays.corners):
            return None
        smooth = read(mesh.polygons, "use_smooth", 1, bool)
        normals = corner_normals(mesh)
        if mesh.has_custom_normals and normals is not None:
            smooth[:] = True
        slot = numpy.clip(material_numbers(mesh), 0, max(len(slots) - 1, 0))
        parts = [self._part(mesh, arrays, corners, slots[k // 2] if slots else None, normals, bool(k % 2))
                 for k, corners in self._groups(arrays, 2 * slot + smooth)]
        return self._once(name, parts)

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
        layers = {"TEXCOORD_%d" % i: texture_places(mesh, name) for i, name in enumerate(look.maps)}
        if look.colours is not None:
            colours = vertex_colours(mesh, look.colours, arrays.vertex_of)
            if colours is None:
                self.report.add("mesh %s: colours %s of its material" % (mesh.name, look.colours or "(active)"))
            else:
                layers["COLOR_0"] = colours
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
                     "indices": self.file.add_accessor(indices)}
        if material is not None:
            primitive["material"] = material
        return primitive
