#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "common/import/mesh_options.h"
#include "common/import/mesh_reader.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

/// Loads the files as one set: OBJ, PLY (text, binary), STL, OFF, OM, glTF 2.0 (what no animation
/// moves).
///
/// @throws Error naming the file and the cause: missing, empty, truncated, foreign, no triangle
/// left
TriangleMesh loadMesh(std::span<const std::filesystem::path> files, const MeshOptions& options);

/// The set that one file's faces make; `path` is for messages.
///
/// @throws Error when no triangle is left
TriangleMesh assembleMesh(const std::filesystem::path& path, RawMesh raw,
                          const MeshOptions& options);

/// The same; nothing when no triangle is left.
std::optional<TriangleMesh> assembleIfAny(const std::filesystem::path& path, RawMesh raw,
                                          const MeshOptions& options);

}  // namespace shadowcache
