#pragma once

#include <cstdint>
#include <vector>

#include "render/cached/regions.h"

namespace shadowcache {

/// Finds the region of a direction among those of a cluster. Reused from cluster to cluster.
class RegionIndex {
public:
    /// A region: a group of Regions::groups, and its place in it.
    struct Place {
        std::int32_t group = -1;  ///< -1: the direction lies in no region
        int lane = 0;
    };

    void build(const Regions& regions);

    /// @param cell  of Environment::kLevel, that holds the direction's light
    Place find(const Regions& regions, std::uint32_t cell) const;

private:
    std::vector<std::int16_t> groups_[Environment::kLevel + 1];  ///< by level and block; -1: none
    std::vector<std::pair<int, std::uint32_t>> used_;
    int coarsest_ = 0, finest_ = -1;  ///< levels with regions
};

}  // namespace shadowcache
