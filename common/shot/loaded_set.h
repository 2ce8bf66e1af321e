#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "common/import/mesh_options.h"
#include "common/import/mesh_reader.h"
#include "common/mesh/mesh.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// A set in memory, ready to be baked and rendered. Immutable; thread-safe.
struct LoadedSet {
    /// @throws Error when memory runs out
    LoadedSet(TriangleMesh loaded, const MeshOptions& loadedWith);
    LoadedSet(const LoadedSet&) = delete;
    LoadedSet& operator=(const LoadedSet&) = delete;

    const MeshOptions options;        ///< that it was loaded with
    const TriangleMesh mesh;          ///< its triangles and materials
    const Scene scene;                ///< of the mesh, for rays
    const std::uint64_t fingerprint;  ///< of the mesh, as caches have it
};

/// Loads the files as one set, without what an animation moves.
///
/// @throws Error as loadMesh()
std::unique_ptr<const LoadedSet> loadSet(std::span<const std::filesystem::path> files,
                                         const MeshOptions& options);

/// The set that faces in memory make.
///
/// @param name  of the set in messages
/// @throws Error when no triangle is left
std::unique_ptr<const LoadedSet> makeSet(const std::filesystem::path& name, RawMesh raw,
                                         const MeshOptions& options);

}  // namespace shadowcache
