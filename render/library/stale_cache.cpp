#include "render/library/stale_cache.h"

#include "common/base/error.h"

namespace shadowcache {

bool isStale(const CacheHeader& header, std::uint64_t fingerprint, const std::string& cache,
             bool staleOk, const NoteSink& note) {
    if (header.fingerprint == fingerprint) return false;
    if (!staleOk)
        throwFileError(cache,
                       "baked for another set (its fingerprint differs): bake this set, or use the "
                       "cache with --stale-ok, which is unbiased but noisier");
    note(cache + ": baked for another set; unbiased, but noisier", NoteKind::warning);
    return true;
}

}  // namespace shadowcache
