#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bake/core/item_counts.h"

namespace shadowcache {

/// Items of some voxels, and the rays that they cost.
struct Baked {
    CacheItems items;
    std::uint64_t rays = 0;
    std::uint64_t emitterRays = 0;  ///< of these: to emitters
};

/// Memory that items take.
std::uint64_t bytesOf(const CacheItems& items);

/// As bytes for a checkpoint, which the same program on the same kind of processor reads back.
std::string toBytes(const Baked& baked);
/// @throws Error if the bytes are cut short
Baked bakedFromBytes(std::string_view bytes);

/// Probes of some voxels, by voxel.
std::string toBytes(const std::vector<std::vector<Probe>>& probes);
/// @throws Error if the bytes are cut short
std::vector<std::vector<Probe>> probesFromBytes(std::string_view bytes);

}  // namespace shadowcache
