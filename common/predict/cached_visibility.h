#pragma once

#include "common/predict/pooled_visibility.h"

namespace shadowcache {

/// Visibility that the counts predict of a region of directions.
struct CachedVisibility {
    float ratio = 1;  ///< visible share, in [0, 1]; 1 where nothing was counted
    float rays = 0;   ///< number of rays that the ratio is worth; 0: nothing was counted
};

/// By the finest pooled counts of cell `cell` (< cellCount(level)) of a level, 0 .. kMaxCacheLevel.
CachedVisibility visibilityOf(const PooledVisibility& pooled, int level, std::uint32_t cell);

/// By the finest pooled counts around a direction (unit, world space).
CachedVisibility visibilityAlong(const PooledVisibility& pooled, const Vec3d& direction);

}  // namespace shadowcache
