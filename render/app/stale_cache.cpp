#include "render/app/stale_cache.h"

#include <cstdio>

#include "common/base/error.h"
#include "common/cache/cache_items.h"
#include "common/mesh/mesh_fingerprint.h"

namespace shadowcache {

std::unique_ptr<ShadowCache> openCacheOfSet(const RenderJob& job, const TriangleMesh& mesh) {
    if (job.cache.empty()) return nullptr;
    auto cache = std::make_unique<ShadowCache>(job.cache, job.memory);
    if (cache->header().fingerprint == fingerprint(mesh)) return cache;
    if (!job.staleOk)
        throwFileError(job.cache,
                       "baked for another set (its fingerprint differs): bake this set, or use the "
                       "cache with --stale-ok, which is unbiased but noisier");
    std::fprintf(stderr,
                 "shadowcache-render: warning: %s: baked for another set; unbiased, but noisier\n",
                 job.cache.c_str());
    return cache;
}

std::optional<std::uint64_t> cacheFingerprint(const RenderJob& job) {
    if (job.cache.empty()) return std::nullopt;
    return readHeader(job.cache).fingerprint;
}

}  // namespace shadowcache
