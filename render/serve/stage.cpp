#include "render/serve/stage.h"

#include <fmt/core.h>

#include <cstdint>

#include "common/base/progress.h"
#include "common/base/watch.h"
#include "common/import/load_mesh.h"

namespace shadowcache {

Stage::Stage(const LoadRequest& request, const std::function<void(const std::string&)>& log)
    : shots_(openShots(request.files, request.mesh, request.fps)), cacheFile_(request.cache) {
    constexpr std::uint64_t kSteps = 4;
    Progress progress("load", kSteps);
    const auto step = [&] {
        progress.add(1);
        throwIfStopped();
    };
    mesh_ = loadMesh(request.files, request.mesh);
    log(fmt::format("set: {}", describe(mesh_.report)));
    step();
    moving_.emplace(shots_, request.dynamic, request.mesh, mesh_.origin, request.fps);
    for (GltfShot& shot : shots_) shot.dropData();
    if (!moving_->empty())
        log(fmt::format("moving: {} triangles, not in the cache", moving_->triangles()));
    step();
    if (!request.cache.empty()) cache_ = openCacheOfSet(request.cache, 0, request.staleOk, mesh_);
    if (cache_.stale)
        log(fmt::format("{}: baked for another set; unbiased, but noisier",
                        request.cache.string()));
    step();
    scene_.emplace(mesh_);
    step();
}

}  // namespace shadowcache
