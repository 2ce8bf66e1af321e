#include "common/shot/loaded_set.h"

#include <utility>

#include "common/import/load_mesh.h"
#include "common/mesh/mesh_fingerprint.h"

namespace shadowcache {

LoadedSet::LoadedSet(TriangleMesh loaded, const MeshOptions& loadedWith)
    : options(loadedWith),
      mesh(std::move(loaded)),
      scene(mesh),
      fingerprint(shadowcache::fingerprint(mesh)) {}

std::unique_ptr<const LoadedSet> loadSet(std::span<const std::filesystem::path> files,
                                         const MeshOptions& options) {
    return std::make_unique<const LoadedSet>(loadMesh(files, options), options);
}

std::unique_ptr<const LoadedSet> makeSet(const std::filesystem::path& name, RawMesh raw,
                                         const MeshOptions& options) {
    requireScale(options.scale);
    return std::make_unique<const LoadedSet>(assembleMesh(name, std::move(raw), options), options);
}

}  // namespace shadowcache
