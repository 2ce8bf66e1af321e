#pragma once

#include "common/predict/pooled_visibility.h"

namespace shadowcache {

/// What the cache knows of a cell of any level: all is open where nothing was counted.
struct CachedVisibility {
    float ratio = 1;
    float rays = 0;
};

/// The finest counts of a cell that the pooled items have.
CachedVisibility visibilityOf(const PooledVisibility& pooled, int level, std::uint32_t cell);

}  // namespace shadowcache
