#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/vec.h"

namespace shadowcache {

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
};

/// Triangle soup in world space. Positions are relative to `origin`, so that sets far from the
/// world's origin keep their precision: world = origin + position.
struct TriangleMesh {
    Vec3d origin{0, 0, 0};
    std::vector<Vec3f> positions;
    std::vector<Vec3i> triangles;  ///< three indices into positions each
    std::vector<Rgb> colors;       ///< linear albedo per vertex, or empty
    MeshReport report;
};

struct MeshOptions {
    bool zUp = false;    ///< the files' up axis is +Z: rotated so that +Y is up
    double scale = 1.0;  ///< files' unit in metres, > 0
};

/// Loads the files as one set: OBJ, PLY (text, binary), STL, OFF, OM.
///
/// @throws Error naming the file and the cause: missing, empty, truncated, foreign, no triangle
/// left
TriangleMesh loadMesh(std::span<const std::filesystem::path> files, const MeshOptions& options);

/// The report in one line for people ("158236 triangles; 3 n-gons cut into 9 triangles; ..."); says
/// nothing of what did not occur.
std::string describe(const MeshReport& report);

/// Hash of the triangles' world positions, independent of vertex order; two sets with the same
/// fingerprint have the same visibility.
std::uint64_t fingerprint(const TriangleMesh& mesh);

}  // namespace shadowcache
