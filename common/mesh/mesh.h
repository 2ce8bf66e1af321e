#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/math/affine.h"
#include "common/math/vec.h"
#include "common/mesh/lamp.h"
#include "common/mesh/material.h"

namespace shadowcache {

/// What is left out of other things than materials, or read in one of several ways: kind and text,
/// {"node", "MSFT_lod is left out"}, and the number of nodes.
using LeftOutOf = std::map<std::pair<std::string, std::string>, std::size_t>;

/// What loading a set found and did; every face of the files is accounted for.
struct MeshReport {
    std::size_t facesRead = 0;  ///< faces in the files, of any number of sides
    std::size_t polygons = 0;   ///< faces with more than three sides, cut into triangles
    std::size_t trianglesFromPolygons = 0;
    std::size_t badVertexFaces = 0;  ///< faces dropped: a corner is not finite or out of range
    std::size_t degenerate = 0;      ///< triangles without area, dropped
    std::size_t duplicates = 0;  ///< triangles with the same three corners as an earlier one, kept
    std::size_t nonManifoldEdges = 0;  ///< edges with more than two triangles
    std::size_t mixedWinding = 0;      ///< edges whose two triangles disagree in orientation
    std::size_t unreferenced = 0;      ///< vertices that no face uses
    std::size_t triangles = 0;         ///< triangles kept
    std::size_t instances = 0;         ///< copies of triangles that are kept once
    std::size_t placed = 0;            ///< triangles in the world, each copy counted
    std::size_t badNormals = 0;  ///< shading normals that are zero, not finite or out of range
    std::size_t badColors = 0;   ///< vertex colours that are not finite or out of range, clamped
    /// Oddities of a file that were read all the same: what follows the number in a report, number.
    std::map<std::string, std::size_t> remarks;
    std::size_t blended = 0;  ///< materials that blend with what is behind
    /// Parts of the files' materials that are not supported: name and number of materials.
    std::map<std::string, std::size_t> leftOut;
    LeftOutOf leftOutOf;
};

/// Where the texture coordinate s grows at a vertex.
struct Tangent {
    Vec3f direction{0, 0, 0};  ///< unit
    /// 1 if up in the picture, where t falls, is normal x direction; -1 if it is the opposite; 0:
    /// there is none.
    float side = 0;
};

/// A run of triangles of one material.
struct MeshPart {
    std::uint32_t firstTriangle = 0;
    std::uint32_t triangleCount = 0;
    int material = -1;  ///< of TriangleMesh::materials; -1: none
};

/// A copy in the world of a run of parts that share one place in memory.
struct MeshInstance {
    std::uint32_t firstPart = 0;
    std::uint32_t partCount = 0;
    Affine toWorld;                 ///< its images are relative to the mesh's origin
    std::uint32_t firstPlaced = 0;  ///< number of its first triangle in the world (placed_mesh.h)
    std::uint32_t triangleCount = 0;
    std::uint32_t source = 0;  ///< its number in RawMesh::instances
};

/// In the place of the colours of vertices that have none, beside others that do.
inline const Rgb kNoColor{-1.0f, -1.0f, -1.0f};

/// Triangle soup in world space. Positions are relative to `origin`, so that sets far from the
/// world's origin keep their precision: world = origin + position. Parts from firstSharedPart on,
/// the last of the triangles, are in the world only through instances, with positions of their own.
struct TriangleMesh {
    Vec3d origin{0, 0, 0};
    std::vector<Vec3f> positions;
    std::vector<Vec3i> triangles;  ///< three indices into positions each
    std::vector<Rgb> colors;  ///< linear albedo per vertex, kNoColor where its file has none; or
                              ///< empty
    std::vector<Vec3f> texcoords;  ///< s, t and opacity of each vertex, or empty
    /// Further texture coordinates of each vertex, by layer (TextureSlot); each may be empty.
    std::vector<std::vector<Vec2f>> moreTexcoords;
    /// Tangents of the vertices for normal maps, in the space of the positions; or empty.
    std::vector<Tangent> tangents;
    std::vector<Vec3f> normals;  ///< unit shading normals, or empty
    /// Three indices into normals for each triangle, -1 where a corner has none; empty if normals
    /// is.
    std::vector<Vec3i> cornerNormals;
    std::vector<MeshPart> parts;  ///< in order of their triangles; empty: one without material
    std::size_t firstSharedPart = 0;
    std::vector<MeshInstance> instances;
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Lamp> lamps;  ///< at places relative to the origin
    MeshReport report;
};

/// The report in one line for people ("158236 triangles; 3 n-gons cut into 9 triangles; ..."); says
/// kinds that did not occur are left out.
std::string describe(const MeshReport& report);

}  // namespace shadowcache
