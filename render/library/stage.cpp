#include "render/library/stage.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>

#include "common/base/process.h"
#include "common/import/load_mesh.h"
#include "common/mesh/mesh_fingerprint.h"

namespace shadowcache {

Stage::Stage(const StageOptions& options, NoteSink note)
    : options_(options),
      note_(std::move(note)),
      shots_(openShots(options.set.files, meshOptionsOf(options.set), options.set.fps)) {}

void Stage::load(const std::function<void()>& onStep) {
    const SetOptions& set = options_.set;
    const MeshOptions meshOptions = meshOptionsOf(set);
    mesh_ = loadMesh(set.files, meshOptions);
    note_(fmt::format("set: {}", describe(mesh_.report)), NoteKind::note);
    stillLamps_ = mesh_.lamps.size();
    objects_ = openDynamic(set.dynamic, meshOptions, set.fps);
    movingLamps_.emplace(shots_, objects_, meshOptions, mesh_.origin);
    std::ranges::move(movingLamps_->unplaced(), std::back_inserter(mesh_.lamps));
    if (!mesh_.lamps.empty()) note_(fmt::format("lamps: {}", mesh_.lamps.size()), NoteKind::note);
    if (const std::size_t moving = mesh_.lamps.size() - stillLamps_; moving > 0)
        note_(fmt::format("moving lamps: {}, not in the cache; while a frame is exposed they stand "
                          "still",
                          moving),
              NoteKind::note);
    onStep();
    moving_.emplace(shots_, objects_, meshOptions, mesh_.origin);
    requireNamed(meshOptions.gains);
    for (GltfShot& shot : shots_) shot.dropData();
    if (!moving_->empty())
        note_(fmt::format("moving: {} triangles, not in the cache", moving_->triangles()),
              NoteKind::note);
    onStep();
    if (!options_.cache.empty()) loadCache(options_.cache);
    onStep();
    const double start = secondsNow();
    scene_.emplace(mesh_);
    sceneSeconds_ = secondsNow() - start;
    onStep();
}

void Stage::loadCache(const std::filesystem::path& cache) {
    cache_ = std::make_unique<ShadowCache>(cache, options_.memory);
    stale_ =
        shadowcache::isStale(cache_->header(), fingerprint(mesh_), cache, options_.staleOk, note_);
}

/// @throws Error as requireMatches()
void Stage::requireNamed(std::span<const LampGain> gains) const {
    std::vector<std::string> names = lampNames(mesh_);
    std::ranges::move(moving_->lampNames(), std::back_inserter(names));
    requireMatches(gains, names);
}

void Stage::setGains(std::span<const LampGain> gains) {
    requireNamed(gains);
    applyGains(gains, mesh_);
    moving_->setGains(gains);
    movingLamps_->setGains(gains);
}

/// @return whether some are not as they were
bool Stage::placeLamps(int frame) {
    std::vector<Lamp> lamps = movingLamps_->at(frame);
    const auto first = mesh_.lamps.begin() + static_cast<std::ptrdiff_t>(stillLamps_);
    if (std::equal(first, mesh_.lamps.end(), lamps.begin(), lamps.end())) return false;
    mesh_.lamps.resize(stillLamps_);
    std::ranges::move(lamps, std::back_inserter(mesh_.lamps));
    return true;
}

bool Stage::pose(int frame) {
    scene_->setMoving(moving_->pose(frame));
    return placeLamps(frame);
}

}  // namespace shadowcache
