"""Bare triangles of a render depsgraph, in Blender's own axes."""

import numpy

from .shown import walk, world_matrices
from .triangles import MeshArrays

HEADER = """ply
format binary_little_endian 1.0
element vertex %d
property double x
property double y
property double z
element face %d
property list uchar int vertex_indices
end_header
"""


def export_ply(depsgraph, path, report):
    report.add("materials, textures, normals and motion: a .ply holds bare triangles")
    places = world_matrices(depsgraph)
    vertices, triangles, known, count = [], [], {}, 0
    for shown in walk(depsgraph, report):
        if shown.kind == "LIGHT":
            report.add("light %s" % shown.name)
        if shown.kind != "MESH":
            continue
        data = shown.thing.data
        if data.as_pointer() not in known:
            arrays = MeshArrays(data)
            for text in arrays.left_out():
                report.add("mesh %s: %s" % (data.name, text))
            known[data.as_pointer()] = arrays.places.astype(float), arrays.vertex_of[arrays.corners]
        points, corners = known[data.as_pointer()]
        if not len(corners):
            continue
        to_world = places[shown.row]
        if numpy.linalg.det(to_world[:3, :3]) < 0:
            corners = corners[:, ::-1]
        vertices.append(points @ to_world[:3, :3].T + to_world[:3, 3])
        triangles.append(corners + numpy.int32(count))
        count += len(points)
    if not triangles:
        raise ValueError("%s: no mesh, curve or text that would be rendered" % path)
    faces = numpy.empty(sum(map(len, triangles)), [("size", "u1"), ("corners", "<i4", 3)])
    faces["size"], faces["corners"] = 3, numpy.concatenate(triangles)
    with open(path, "wb") as out:
        out.write((HEADER % (count, len(faces))).encode())
        for points in vertices:
            out.write(points.astype("<f8"))
        out.write(faces)
