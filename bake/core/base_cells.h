#pragma once

#include <cstdint>
#include <vector>

#include "bake/core/patch.h"
#include "common/cache/cache_items.h"

namespace shadowcache {

/// Geometry of the base cells, for leaving out those below a patch's horizon.
struct BaseCells {
    explicit BaseCells(const DirectionTiers& tiers);

    /// Indices of the cells that are not wholly below the horizon of every origin of the patch.
    std::vector<std::uint32_t> above(const Patch& patch) const;

    std::vector<Vec3f> axis;
    std::vector<float> radius;  ///< angle around the axis that holds the cell [rad]
};

}  // namespace shadowcache
