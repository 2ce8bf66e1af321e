"""Where an image lies on a mesh: coordinates of the mesh, and what nodes make of them."""

from dataclasses import dataclass

import numpy
from mathutils import Euler, Matrix

from .node_values import constant, feed_of, link_of
from .triangles import read

IDENTITY = tuple(map(tuple, numpy.eye(4)))


@dataclass(frozen=True)
class Coordinates:
    """Three numbers for each loop of a mesh, times a matrix."""
    kind: str = "LAYER"       # LAYER: a UV map or another attribute; GENERATED; OBJECT: the vertices themselves
    name: str = ""            # of the layer, "" for the UV map of renders
    matrix: tuple = IDENTITY  # rows, of affine coordinates

    def then(self, matrix):
        """With another matrix applied afterwards."""
        product = numpy.array(matrix, float) @ numpy.array(self.matrix)
        return Coordinates(self.kind, self.name, tuple(map(tuple, product.tolist())))

    def turns(self):
        """Whether the image lies otherwise than upright on the layer: tangents of the two differ."""
        (a, b, *_), (c, d, *_) = self.matrix[:2]
        return self.kind != "LAYER" or bool(b or c) or a <= 0 or d <= 0


def mapping_matrix(kind, location, rotation, scale):
    """What Mapping makes of a vector, in Cycles; None where it is no matrix."""
    turn = Euler(rotation).to_matrix().to_4x4()
    size = Matrix.Diagonal((*scale, 1))
    if kind == "POINT":
        return Matrix.Translation(location) @ turn @ size
    if kind == "VECTOR":
        return turn @ size
    if kind == "TEXTURE" and all(scale):
        return (Matrix.Translation(location) @ turn @ size).inverted()
    return None


def own_matrix(own):
    """Of an image node's own mapping, which no editor shows; None where it is no matrix."""
    if own.use_min or own.use_max or own.mapping != "FLAT":
        return None
    axes = Matrix(((0,) * 4,) * 4)
    axes[3][3] = 1
    for row, axis in enumerate((own.mapping_x, own.mapping_y, own.mapping_z)):
        if axis != "NONE":
            axes[row]["XYZ".index(axis)] = 1
    matrix = mapping_matrix(own.vector_type, own.translation, own.rotation, own.scale)
    return matrix and matrix @ axes


def coordinates_of(node, reader):
    """Coordinates of an image node, and the name of a node that cannot be expressed, or None."""
    found, unknown = of_input(node.inputs["Vector"], reader)
    matrix = own_matrix(node.texture_mapping)
    return (found, unknown or "Mapping of its own") if matrix is None else (found.then(matrix), unknown)


def of_input(socket, reader):
    feed = feed_of(socket)
    if feed is None:
        return Coordinates(), None
    if feed.output is None or "VALUE" in feed.kinds:
        return Coordinates(), "a muted node"
    output, node = feed.output, feed.output.node
    if node.type == "MAPPING":
        if feed_of(node.inputs["Vector"]) is None:
            return Coordinates(), "Mapping"
        before, unknown = of_input(node.inputs["Vector"], reader)
        settings = [s for s in node.inputs if s.name != "Vector" and s.enabled]
        values = {s.name: constant(s) for s in settings}
        matrix = mapping_matrix(node.vector_type, values.get("Location", (0, 0, 0)), values["Rotation"], values["Scale"])
        if matrix is None or any(link_of(s) for s in settings):
            return before, unknown or "Mapping"
        reader.see(node)
        return before.then(matrix), unknown
    found = of_node(node, output)
    if found is None:
        return Coordinates(), node.bl_label + (" " + output.name if node.type == "TEX_COORD" else "")
    reader.see(node)
    return found, None


def of_node(node, output):
    if node.type == "TEX_COORD":
        if output.name == "UV":
            return Coordinates()
        if output.name == "Generated":
            return Coordinates("GENERATED")
        return Coordinates("OBJECT") if output.name == "Object" and not node.object else None
    if node.type == "UVMAP":
        return Coordinates(name=node.uv_map)
    if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY" and output.name in ("Vector", "Color"):
        return Coordinates(name=node.attribute_name)
    return None


def vertex_places(mesh, undeformed=False):
    return read(mesh.vertices, "undeformed_co" if undeformed else "co", 3, numpy.float32)


def generated(mesh):
    """Of the vertices: undeformed places in the texture space, from 0 to 1."""
    size = numpy.array(mesh.texspace_size, float)
    size = numpy.divide(0.5, size, out=numpy.zeros(3), where=size != 0)
    return vertex_places(mesh, undeformed=True) * size - (numpy.array(mesh.texspace_location, float) * size - 0.5)


# Of attributes: the property, its width, and its type.
STORED = {"FLOAT2": ("vector", 2, numpy.float32), "FLOAT_VECTOR": ("vector", 3, numpy.float32),
          "FLOAT_COLOR": ("color", 4, numpy.float32), "BYTE_COLOR": ("color", 4, numpy.float32),
          "FLOAT": ("value", 1, numpy.float32), "INT": ("value", 1, numpy.int32), "BOOLEAN": ("value", 1, bool)}
DOMAINS = ("POINT", "CORNER", "FACE")
# Attributes that Cycles makes where a mesh has none of the name.
OF_CYCLES = {"N", "Ng", "uv", "generated", "generated_transform", "tangent", "tangent_sign", "vertex_color", "undeformed",
             "undisplaced", "motion_P", "motion_N", "particle", "pointiness", "random_per_island"}


def unread_of(mesh, name):
    """Why an attribute of a mesh is not read, as a text; empty if it is, or is not there, which is 0."""
    if mesh.uv_layers.get(name) is not None:
        return ""
    attribute = mesh.attributes.get(name)
    if attribute is None:
        return "attribute %s, which Cycles makes" % name if name in OF_CYCLES else ""
    if attribute.data_type in STORED and attribute.domain in DOMAINS:
        return ""
    return "attribute %s: %s of %s" % (name, attribute.data_type.lower(), attribute.domain.lower())


def layer_of(mesh, name, vertex_of):
    """Four numbers of an attribute for each loop, as Cycles reads them as a colour; 0 where the mesh has no such
    attribute."""
    layer = mesh.uv_layers.get(name)
    values = numpy.zeros((len(vertex_of), 4), numpy.float32)
    values[:, 3] = 1
    if layer is not None:
        values[:, :2] = read(layer.data, "uv", 2, numpy.float32)
        return values
    attribute = mesh.attributes.get(name)
    if attribute is None or unread_of(mesh, name):
        values[:, 3] = 0
        return values
    stored, width, kind = STORED[attribute.data_type]
    found = read(attribute.data, stored, width, kind).astype(numpy.float32).reshape(-1, width)
    if attribute.domain == "POINT":
        found = found[vertex_of]
    elif attribute.domain == "FACE":
        found = found[polygon_of_loop(mesh)]
    values[:, :width] = found
    if width == 1:
        values[:, 1:3] = found
    return values


def polygon_of_loop(mesh):
    start = read(mesh.polygons, "loop_start", 1, numpy.int32)
    total = read(mesh.polygons, "loop_total", 1, numpy.int32)
    found = numpy.zeros(len(mesh.loops), numpy.int32)
    order = numpy.repeat(numpy.arange(len(start), dtype=numpy.int32), total)
    found[numpy.repeat(start, total) + numpy.arange(len(order)) - numpy.repeat(numpy.cumsum(total) - total, total)] = order
    return found


def texture_places(mesh, where, vertex_of):
    """Texture coordinates of the loops, t downwards as glTF has it."""
    if where.kind == "GENERATED":
        places = generated(mesh)[vertex_of]
    elif where.kind == "OBJECT":
        places = vertex_places(mesh)[vertex_of]
    else:
        active = next((u.name for u in mesh.uv_layers if u.active_render), "")
        places = layer_of(mesh, where.name or active, vertex_of)[:, :3]
    if where.matrix != IDENTITY:
        matrix = numpy.array(where.matrix)[:2]
        places = places @ matrix[:, :3].T + matrix[:, 3]
    places = numpy.array(places[:, :2], numpy.float32)
    places[:, 1] = 1 - places[:, 1]
    return places
