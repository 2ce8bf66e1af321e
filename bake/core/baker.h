#pragma once

#include "bake/core/options.h"
#include "common/cache/cache_items.h"
#include "common/trace/scene.h"

namespace shadowcache {

struct BakeResult {
    CacheHeader header;
    CacheItems items;
    std::uint64_t rays = 0;
};

/// Bakes the visibility of a set: for every voxel its surface passes through and every side of it,
/// how many rays into each direction region reach the sky. A pure function of its arguments,
/// whatever the number of threads. Shows progress; Ctrl-C ends it with Error.
///
/// @throws Error on impossible options
BakeResult bake(const Scene& scene, const BakeOptions& options);

}  // namespace shadowcache
