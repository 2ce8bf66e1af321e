#pragma once

#include <cstddef>
#include <cstdint>

#include "common/cache/cache_items.h"

namespace shadowcache {

/// What baking a sample of the voxels of a bake took.
struct BakeSample {
    CacheHeader header;
    CacheItems items;
    std::size_t voxels = 0;    ///< of the sample
    std::size_t ofVoxels = 0;  ///< of the whole bake
    std::size_t probes = 0;    ///< voxels with probe rays: the sample and the voxels around it
    std::size_t ofProbes = 0;  ///< the same of the whole bake; 0: it needs none
    std::uint64_t probeRays = 0, itemRays = 0;
    std::uint64_t emitterRays = 0;             ///< of itemRays: to emitters
    double probeSeconds = 0, itemSeconds = 0;  ///< wall-clock time, summed over the threads
};

}  // namespace shadowcache
