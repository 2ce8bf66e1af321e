#include "common/shot/loaded_set.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/import/load_mesh.h"
#include "common/mesh/mesh_fingerprint.h"
#include "common/shot/gltf_shot.h"
#include "common/shot/moving_lamps.h"
#include "common/shot/moving_set.h"

namespace shadowcache {

namespace {

/// Where something moves.
MovingShots movingShotsOf(std::span<const std::filesystem::path> files, const MeshOptions& options,
                          double fps) {
    std::vector<GltfShot> shots = openShots(files, options, fps);
    std::erase_if(shots, [](const GltfShot& shot) {
        return shot.movingNodes().empty() && shot.movingLampNodes().empty();
    });
    if (shots.empty()) return nullptr;
    return std::make_shared<const std::vector<GltfShot>>(std::move(shots));
}

MovingLamps movingLampsOf(const LoadedSet& set) {
    const std::span<const GltfShot> shots =
        set.shots ? std::span<const GltfShot>(*set.shots) : std::span<const GltfShot>();
    return {shots, {}, set.options, set.mesh.origin};
}

}  // namespace

LoadedSet::LoadedSet(TriangleMesh loaded, const MeshOptions& loadedWith, MovingShots movingShots,
                     std::optional<int> inFrame)
    : options(loadedWith),
      shots(std::move(movingShots)),
      frame(inFrame),
      mesh(std::move(loaded)),
      scene(mesh),
      fingerprint(shadowcache::fingerprint(mesh)) {
    if (!shots || !frame) return;
    moving_ =
        std::make_unique<MovingSet>(*shots, std::span<const DynamicObject>(), options, mesh.origin);
    scene.setMoving(moving_->pose(*frame));
}

LoadedSet::~LoadedSet() = default;

std::unique_ptr<const LoadedSet> loadSet(std::span<const std::filesystem::path> files,
                                         const MeshOptions& options, double fps) {
    return std::make_unique<const LoadedSet>(loadMesh(files, options), options,
                                             movingShotsOf(files, options, fps));
}

std::unique_ptr<const LoadedSet> setAt(const LoadedSet& set, int frame) {
    TriangleMesh mesh = set.mesh;
    std::ranges::move(movingLampsOf(set).at(frame), std::back_inserter(mesh.lamps));
    return std::make_unique<const LoadedSet>(std::move(mesh), set.options, set.shots, frame);
}

std::vector<std::string> namesForGains(const LoadedSet& set) {
    std::vector<std::string> names = lampNames(set.mesh);
    for (const Lamp& lamp : movingLampsOf(set).unplaced()) names.push_back(lamp.name);
    return names;
}

std::unique_ptr<const LoadedSet> makeSet(const std::filesystem::path& name, RawMesh raw,
                                         const MeshOptions& options) {
    requireScale(options.scale);
    return std::make_unique<const LoadedSet>(assembleMesh(name, std::move(raw), options), options);
}

}  // namespace shadowcache
