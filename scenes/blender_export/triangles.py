"""Triangles of a Blender mesh, as numpy arrays in the mesh's own axes.

Blender's list of loop triangles is the slowest to read of all that a mesh has, so that triangles and quads are cut
here, as Blender cuts them; only where there are larger polygons is that list read.
"""

import numpy


def read(items, name, width, kind):
    """A property of all items of one of Blender's collections: an array of `width` numbers each."""
    values = numpy.empty(len(items) * width, kind)
    items.foreach_get(name, values)
    return values if width == 1 else values.reshape(-1, width)


class MeshArrays:
    """What both forms of the export read: places, corners, and the corners of the triangles."""

    def __init__(self, mesh):
        self.places = read(mesh.vertices, "co", 3, numpy.float32)
        self.vertex_of = read(mesh.loops, "vertex_index", 1, numpy.int32)
        corners, polygon_of = cut(mesh, self.places, self.vertex_of)
        whole = numpy.isfinite(self.places).all(axis=1)[self.vertex_of[corners]].all(axis=1)
        self.dropped = int(len(whole) - whole.sum())
        self.corners, self.polygon_of = (corners[whole], polygon_of[whole]) if self.dropped else (corners, polygon_of)

    def left_out(self):
        """As texts."""
        return ["%d triangles with a vertex that is no number" % self.dropped] if self.dropped else []


def cut(mesh, places, vertex_of):
    """Three corners (numbers of loops) for each triangle, and the polygon that it is of."""
    start = read(mesh.polygons, "loop_start", 1, numpy.int32)
    total = read(mesh.polygons, "loop_total", 1, numpy.int32)
    corners, polygons = [], []
    three = numpy.flatnonzero(total == 3)
    if three.size:
        corners.append(start[three, None] + numpy.arange(3, dtype=numpy.int32))
        polygons.append(three)
    four = numpy.flatnonzero(total == 4)
    if four.size:
        corners.append(cut_quads(start[four], places, vertex_of))
        polygons.append(numpy.repeat(four, 2))
    if three.size + four.size < total.size:
        mesh.calc_loop_triangles()
        polygon_of = read(mesh.loop_triangles, "polygon_index", 1, numpy.int32)
        larger = total[polygon_of] > 4
        corners.append(read(mesh.loop_triangles, "loops", 3, numpy.int32)[larger])
        polygons.append(polygon_of[larger])
    if not corners:
        return numpy.empty((0, 3), numpy.int32), numpy.empty(0, numpy.int32)
    return numpy.concatenate(corners), numpy.concatenate(polygons)


def cut_quads(start, places, vertex_of):
    """Two triangles for each quad: along corners 0 and 2, or 1 and 3 where both others are on one side of that line."""
    first = places[vertex_of[start]]
    a, b, c = (places[vertex_of[start + k]] - first for k in (1, 2, 3))

    def dot(x, y):
        return numpy.einsum("ij,ij->i", x, y)

    # (a x b) . (c x b) > 0, by the identity of Lagrange.
    flipped = dot(a, c) * dot(b, b) > dot(a, b) * dot(b, c)
    order = numpy.array([0, 1, 2, 0, 2, 3], numpy.int32)
    corners = start[:, None] + order
    if flipped.any():
        corners[flipped] = start[flipped, None] + numpy.array([0, 1, 3, 1, 2, 3], numpy.int32)
    return corners.reshape(-1, 3)


def share(corners, vertex_of, layers, vertices):
    """One vertex for all corners of a place that agree in all layers.

    corners: numbers of loops, any shape. layers: arrays of 32-bit numbers, a row for each loop. Returns a loop for
    each vertex that is needed, and the vertex of each corner."""
    used = numpy.zeros(len(vertex_of), bool)
    used[corners.reshape(-1)] = True
    todo = numpy.flatnonzero(used).astype(numpy.int32)
    bits = [layer.view(numpy.uint32) for layer in layers]
    leader = numpy.empty(len(vertex_of), numpy.int32)
    speaker = numpy.empty(vertices, numpy.int32)
    kept = numpy.zeros(len(vertex_of), bool)
    # In each round some loop speaks for its place, and those that differ from it go on to the next.
    while todo.size:
        place = vertex_of[todo]
        speaker[place] = todo
        spoken = speaker[place]
        same = numpy.ones(len(todo), bool)
        for layer in bits:
            for column in layer.T:
                same &= column[todo] == column[spoken]
        leader[todo[same]] = spoken[same]
        kept[spoken] = True
        todo = todo[~same]
    number = numpy.cumsum(kept, dtype=numpy.uint32) - numpy.uint32(1)
    return numpy.flatnonzero(kept), number[leader[corners.reshape(-1)]]
