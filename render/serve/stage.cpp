#include "render/serve/stage.h"

#include <fmt/core.h>

#include "common/base/watch.h"
#include "common/import/load_mesh.h"

namespace shadowcache {

namespace {

CacheOfSet openedCache(const LoadRequest& request, const TriangleMesh& mesh) {
    throwIfStopped();
    if (request.cache.empty()) return {};
    return openCacheOfSet(request.cache, 0, request.staleOk, mesh);
}

}  // namespace

Stage::Stage(const LoadRequest& request, const std::function<void(const std::string&)>& log)
    : shots_(openShots(request.files, request.mesh, request.fps)),
      mesh_(loadMesh(request.files, request.mesh)),
      moving_(shots_, request.dynamic, request.mesh, mesh_.origin, request.fps),
      cacheFile_(request.cache),
      cache_(openedCache(request, mesh_)),
      scene_(mesh_) {
    for (GltfShot& shot : shots_) shot.dropData();
    log(fmt::format("set: {}", describe(mesh_.report)));
    if (!moving_.empty())
        log(fmt::format("moving: {} triangles, not in the cache", moving_.triangles()));
    if (cache_.stale)
        log(fmt::format("{}: baked for another set; unbiased, but noisier", request.cache.string()));
}

}  // namespace shadowcache
