#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "common/shot/camera_source.h"
#include "common/shot/gltf_shot.h"
#include "common/shot/moving_lamps.h"
#include "common/shot/moving_set.h"
#include "render/library/job.h"
#include "render/library/stale_cache.h"

namespace shadowcache {

/// A set in memory, what moves in it, its cache, and the scene of both for rays.
class Stage {
public:
    /// Opens the files that have cameras and animations, which takes no time.
    ///
    /// @param note  has lines for people
    /// @throws Error naming what cannot be read
    Stage(const StageOptions& options, NoteSink note);

    /// Loads the set and the cache.
    ///
    /// @param onStep  is called after each of kSteps
    /// @throws Error naming what cannot be read; a cache that is stale and may not be
    void load(const std::function<void()>& onStep = [] {});
    static constexpr int kSteps = 4;

    /// Loads a cache, in place of none. @throws Error as load()
    void loadCache(const std::filesystem::path& cache);

    const TriangleMesh& mesh() const { return mesh_; }
    const Scene& scene() const { return *scene_; }
    /// Null without one.
    const ShadowCache* cache() const { return cache_.get(); }
    bool isStale() const { return stale_; }
    double sceneSeconds() const { return sceneSeconds_; }  ///< that load() took for the scene

    /// Cameras of the set, or of a file. They refer to the stage.
    CameraSource cameras(const CameraOptions& options) const { return {options, shots_}; }

    /// Multiplies the light of what shines by these gains, in place of those that it has. A
    /// LitStage is told by LitStage::updateLamps().
    ///
    /// @throws Error if a pattern matches nothing
    void setGains(std::span<const LampGain> gains);

    /// @throws Error if a track has no such frame
    void requireFrame(int frame) const { moving_->requireFrame(frame); }
    /// Puts what moves where it is in a frame.
    ///
    /// @return whether lamps are not where they were: a LitStage is told by LitStage::moveLamps()
    /// @throws Error if a track has no such frame
    bool pose(int frame);

private:
    bool placeLamps(int frame);
    void requireNamed(std::span<const LampGain> gains) const;

    const StageOptions options_;
    const NoteSink note_;
    std::vector<GltfShot> shots_;
    TriangleMesh mesh_;           ///< its last lamps are those that move
    std::size_t stillLamps_ = 0;  ///< number of its first ones, which do not
    std::vector<DynamicObject> objects_;
    std::optional<MovingSet> moving_;
    std::optional<MovingLamps> movingLamps_;
    std::unique_ptr<ShadowCache> cache_;
    bool stale_ = false;
    std::optional<Scene> scene_;
    double sceneSeconds_ = 0;
};

}  // namespace shadowcache
