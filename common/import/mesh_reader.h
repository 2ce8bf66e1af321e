#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/import/references.h"
#include "common/math/affine.h"
#include "common/math/vec.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

/// A run of faces of one material.
struct RawPart {
    std::size_t faceCount = 0;
    int material = -1;  ///< of RawMesh::materials; -1: none
    int group = 0;      ///< 0: in the world as they are; others: only where instances put them
};

/// A copy of a group's faces.
struct RawInstance {
    int group = 1;
    Affine toWorld;
    Affine toGroup{};  ///< of toWorld, from the vertices as they are here to those of the file
};

/// Faces exactly as a file tells them: nothing welded, mended or dropped.
struct RawMesh {
    std::vector<Vec3d> vertices;
    std::vector<std::uint32_t> faceVertices;  ///< corners of all faces, one face after the other
    std::vector<std::uint32_t> faceSizes;     ///< corners of each face; may be below 3
    std::vector<Rgb> colors;                  ///< linear, one for each vertex, or empty
    std::vector<Vec3f> texcoords;             ///< s, t and opacity, one for each vertex, or empty
    /// Further texture coordinates, by layer (TextureSlot); each one for each vertex, or empty.
    std::vector<std::vector<Vec2f>> moreTexcoords;
    std::vector<Tangent> tangents;  ///< one for each vertex, of any length, or empty
    std::vector<Vec3d> normals;     ///< shading normals, of any length, or empty
    /// Index into normals of each of faceVertices, kNoVertex for none; empty: normals has one for
    /// each vertex.
    std::vector<std::uint32_t> faceNormals;
    std::vector<RawPart> parts;  ///< in order of the faces, all of them; empty: no materials
    std::vector<RawInstance> instances;
    /// Vertices from here on belong to groups other than 0. No group's faces use another's.
    std::size_t firstLocalVertex = std::numeric_limits<std::size_t>::max();
    std::vector<Material> materials;
    std::vector<Texture> textures;
    std::vector<Lamp> lamps;
    std::size_t moving = 0;  ///< nodes whose meshes are not here, because an animation moves them
    std::size_t badColors = 0;  ///< as MeshReport::badColors
    /// As MeshReport::remarks.
    std::map<std::string, std::size_t> remarks;
    std::size_t blended = 0;                     ///< materials that blend with what is behind
    std::map<std::string, std::size_t> leftOut;  ///< as MeshReport::leftOut
    LeftOutOf leftOutOf;                         ///< as MeshReport::leftOutOf
};

/// Corner that names no vertex of the file.
inline constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

/// Colour of vertices without one in a file where others have one.
inline const Rgb kUncolored{1.0f, 1.0f, 1.0f};

/// Remark on materials of which a number is not what the file says.
inline constexpr const char* kClampedMaterials =
    "materials with numbers out of range or not finite, clamped";

/// Reads one file of one format.
///
/// @throws Error naming the file and the cause: empty, truncated, foreign, newer
using MeshReader = RawMesh (*)(const std::filesystem::path&);

/// What no animation moves, or all of it as it is at a time.
///
/// @param stillAt  [s]
RawMesh readGltf(const std::filesystem::path& path, References references,
                 std::optional<double> stillAt = {});
RawMesh readObj(const std::filesystem::path& path, References references);
RawMesh readOff(const std::filesystem::path& path);
RawMesh readOm(const std::filesystem::path& path);
RawMesh readPly(const std::filesystem::path& path);
RawMesh readStl(const std::filesystem::path& path);

/// Whether the file's extension is that of glTF.
bool isGltf(const std::filesystem::path& path);

/// Reads a file with the reader that its extension asks for; a new format is a reader and a line in
/// the table of mesh_reader.cpp.
///
/// @throws Error as the readers do, and for an unknown extension
RawMesh readMeshFile(const std::filesystem::path& path, References references,
                     std::optional<double> stillAt = {});

}  // namespace shadowcache
