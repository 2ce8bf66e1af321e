#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/import/mesh_options.h"
#include "common/import/mesh_reader.h"
#include "common/mesh/mesh.h"
#include "common/trace/scene.h"

namespace shadowcache {

class GltfShot;
class MovingSet;

/// Files of a set in which something moves; null: there are none.
using MovingShots = std::shared_ptr<const std::vector<GltfShot>>;

/// A set in memory, ready to be baked and rendered. Immutable; thread-safe.
struct LoadedSet {
    /// @param movingShots  what moves in them is left out, but for the frame's
    /// @throws Error when memory runs out, or the frame puts something out of reach
    LoadedSet(TriangleMesh loaded, const MeshOptions& loadedWith, MovingShots movingShots = nullptr,
              std::optional<int> inFrame = std::nullopt);
    LoadedSet(const LoadedSet&) = delete;
    LoadedSet& operator=(const LoadedSet&) = delete;
    ~LoadedSet();

    const MeshOptions options;       ///< that it was loaded with
    const MovingShots shots;         ///< its files in which something moves
    const std::optional<int> frame;  ///< of what moves in it; none: that is left out
    const TriangleMesh mesh;  ///< its triangles that stand still, its materials, and all its lamps
    Scene scene;              ///< of the mesh and of what moves, for rays
    const std::uint64_t fingerprint;  ///< of the mesh, as caches have it

private:
    std::unique_ptr<MovingSet> moving_;  ///< in the scene; null: nothing moves there
};

/// Loads the files as one set, without what an animation moves.
///
/// @param fps  frames per second of animations
/// @throws Error as loadMesh()
std::unique_ptr<const LoadedSet> loadSet(std::span<const std::filesystem::path> files,
                                         const MeshOptions& options, double fps = 24);

/// The same set with what moves in its files where it is in a frame: lamps are its mesh's last
/// ones, and objects are in its scene alone.
///
/// @pre `set` is in no frame
/// @throws Error naming a file: something is out of reach
std::unique_ptr<const LoadedSet> setAt(const LoadedSet& set, int frame);

/// Names that gains may have, those of lamps that move with them.
std::vector<std::string> namesForGains(const LoadedSet& set);

/// The set that faces in memory make.
///
/// @param name  of the set in messages
/// @throws Error when no triangle is left
std::unique_ptr<const LoadedSet> makeSet(const std::filesystem::path& name, RawMesh raw,
                                         const MeshOptions& options);

}  // namespace shadowcache
