#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "common/import/mesh_options.h"
#include "common/import/mesh_reader.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

using Corners = std::array<std::uint32_t, 3>;

/// Material and group of a run of triangles; group 0 is in the world, others where instances put
/// them.
using PartKey = std::pair<int, int>;

/// Triangles of all files so far, in world space; those of groups other than 0 in their own.
struct MeshSoup {
    std::vector<Vec3d> vertices;
    std::vector<Corners> triangles;
    std::vector<Rgb> colors;
    std::vector<Vec3f> texcoords;
    std::vector<Tangent> tangents;                  ///< those of the groups in their own space
    std::vector<std::vector<Vec2f>> moreTexcoords;  ///< by layer; each may be empty
    std::vector<Vec3f> normals;           ///< unit; those of the groups in their own space
    std::vector<Corners> cornerNormals;   ///< by triangle, kNoVertex: none; empty if normals is
    std::vector<PartKey> parts{{0, -1}};  ///< group, material
    std::vector<std::uint32_t> partOf;    ///< by triangle; empty: all are of part 0
    std::vector<RawInstance> instances;
    std::vector<std::pair<std::size_t, std::size_t>> local;  ///< ranges of the groups' vertices
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Lamp> lamps;
    int groups = 0;
    std::size_t moving = 0;  ///< as RawMesh::moving
    MeshReport report;

    /// Of a triangle; 0: in the world.
    int groupOf(std::size_t triangle) const {
        return parts[partOf.empty() ? 0 : partOf[triangle]].first;
    }
    /// As the renderer will see it.
    Vec3f position(std::size_t vertex, const Vec3d& origin) const;
};

/// Adds a file's faces, cut into triangles, and its looks; faces of bad vertices are dropped and
/// counted.
///
/// @throws Error naming the file: a concave face with too many corners, too many vertices
void append(const std::filesystem::path& path, RawMesh raw, const MeshOptions& options,
            MeshSoup& soup);

}  // namespace shadowcache
