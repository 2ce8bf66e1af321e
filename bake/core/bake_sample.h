#pragma once

#include <cstddef>
#include <cstdint>

#include "common/cache/cache_items.h"

namespace shadowcache {

/// What baking a sample of the voxels of a bake took.
struct BakeSample {
    CacheHeader header;
    CacheItems items;
    std::size_t voxels = 0;    ///< baked
    std::size_t ofVoxels = 0;  ///< that the whole bake bakes
    std::size_t probes = 0;  ///< voxels whose probe rays were traced: those, and those around them
    std::size_t ofProbes = 0;  ///< whose probe rays the whole bake traces; 0: it needs none
    std::uint64_t probeRays = 0, itemRays = 0;
    double probeSeconds = 0, itemSeconds = 0;  ///< of all threads together, as a clock has them
};

}  // namespace shadowcache
