#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

#include "common/vec.h"

namespace shadowcache {

/// Faces exactly as a file tells them: nothing welded, mended or dropped.
struct RawMesh {
    std::vector<Vec3d> vertices;
    std::vector<std::uint32_t> faceVertices;  ///< corners of all faces, one face after the other
    std::vector<std::uint32_t> faceSizes;     ///< corners of each face; may be below 3
    std::vector<Rgb> colors;                  ///< linear, one for each vertex, or empty
};

/// Corner that names no vertex of the file.
inline constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

/// Colour of vertices without one in a file, or a set, where others have one.
inline const Rgb kUncolored{1.0f, 1.0f, 1.0f};

/// Reads one file of one format.
///
/// @throws Error naming the file and the cause: empty, truncated, foreign, newer
using MeshReader = RawMesh (*)(const std::filesystem::path&);

RawMesh readObj(const std::filesystem::path& path);
RawMesh readOff(const std::filesystem::path& path);
RawMesh readOm(const std::filesystem::path& path);
RawMesh readPly(const std::filesystem::path& path);
RawMesh readStl(const std::filesystem::path& path);

/// Reads a file with the reader that its extension asks for; a new format is a reader and a line in
/// the table of mesh_reader.cpp.
///
/// @throws Error as the readers do, and for an unknown extension
RawMesh readMeshFile(const std::filesystem::path& path);

}  // namespace shadowcache
