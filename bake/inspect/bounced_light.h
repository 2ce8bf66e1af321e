#pragma once

#include <filesystem>
#include <vector>

#include "common/cache/cache_items.h"
#include "common/light/environment.h"

namespace shadowcache {

/// Irradiance of a cache's items under an environment with the light of all bounces, as its counts
/// and its transport predict it for surfaces of albedo 1/2. [radiance sr]
///
/// @param path   of the cache
/// @param items  of the same cache; the result is in their order
/// @throws Error naming the file if it holds no transport
std::vector<Rgb> bouncedIrradiance(const std::filesystem::path& path, const CacheItems& items,
                                   const Environment& environment);

}  // namespace shadowcache
