#include "render/app/job_cache.h"

#include <cstdio>
#include <utility>

#include "common/cache/cache_items.h"
#include "render/library/stale_cache.h"

namespace shadowcache {

std::unique_ptr<ShadowCache> openCacheOfSet(const RenderJob& job, const TriangleMesh& mesh) {
    if (job.cache.empty()) return nullptr;
    CacheOfSet opened = openCacheOfSet(job.cache, job.memory, job.staleOk, mesh);
    if (!opened.stale) return std::move(opened.cache);
    std::fprintf(stderr,
                 "shadowcache-render: warning: %s: baked for another set; unbiased, but noisier\n",
                 job.cache.c_str());
    return std::move(opened.cache);
}

std::optional<std::uint64_t> cacheFingerprint(const RenderJob& job) {
    if (job.cache.empty()) return std::nullopt;
    return readHeader(job.cache).fingerprint;
}

}  // namespace shadowcache
