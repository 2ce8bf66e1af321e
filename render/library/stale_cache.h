#pragma once

#include <cstdint>
#include <string>

#include "common/cache/shadow_cache.h"
#include "render/shot/environment_loader.h"

namespace shadowcache {

/// Whether a cache is stale: its fingerprint is not that of the set, which has changed since.
///
/// @param cache    what messages call it
/// @param staleOk  whether it may be
/// @param note     is warned of one that may
/// @throws Error if it is stale, and may not be
bool isStale(const CacheHeader& header, std::uint64_t fingerprint, const std::string& cache,
             bool staleOk, const NoteSink& note);

}  // namespace shadowcache
