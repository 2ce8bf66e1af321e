#include "render/library/stale_cache.h"

#include "common/base/error.h"
#include "common/mesh/mesh_fingerprint.h"

namespace shadowcache {

CacheOfSet openCacheOfSet(const std::filesystem::path& path, std::uint64_t memory, bool staleOk,
                          const TriangleMesh& mesh) {
    CacheOfSet opened{std::make_unique<ShadowCache>(path, memory)};
    opened.stale = opened.cache->header().fingerprint != fingerprint(mesh);
    if (opened.stale && !staleOk)
        throwFileError(path,
                       "baked for another set (its fingerprint differs): bake this set, or use the "
                       "cache with --stale-ok, which is unbiased but noisier");
    return opened;
}

void requireTransport(const Shot& shot, const RenderOptions& options,
                      const std::filesystem::path& cache) {
    if (shot.missesTransport() && (options.samples == 0 || options.preview))
        throwFileError(cache,
                       "holds no transport, of which a preview of bounces is made: bake "
                       "without --no-transport, or render with --bounces 0");
}

}  // namespace shadowcache
