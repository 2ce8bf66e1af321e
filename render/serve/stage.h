#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/shot/gltf_shot.h"
#include "render/library/stale_cache.h"
#include "render/serve/requests.h"

namespace shadowcache {

/// What a load request brings into memory: a set, what moves in it, and its cache.
class Stage {
public:
    /// Shows progress, one step after another.
    ///
    /// @param log  has lines for people
    /// @throws Error naming what cannot be read
    Stage(const LoadRequest& request, const std::function<void(const std::string&)>& log);

    const TriangleMesh& mesh() const { return mesh_; }
    const Scene& scene() const { return *scene_; }
    const ShadowCache* cache() const { return cache_.cache.get(); }
    const std::filesystem::path& cacheFile() const { return cacheFile_; }
    bool isStale() const { return cache_.stale; }

    /// Cameras of the set, or of a file. They refer to the stage.
    CameraSource cameras(const CameraOptions& options) const { return {options, shots_}; }

    /// Puts what moves where it is in a frame. @throws Error if a track has no such frame
    void pose(int frame) { scene_->setMoving(moving_->pose(frame)); }

private:
    std::vector<GltfShot> shots_;
    TriangleMesh mesh_;
    std::optional<MovingSet> moving_;
    std::filesystem::path cacheFile_;
    CacheOfSet cache_;
    std::optional<Scene> scene_;
};

}  // namespace shadowcache
