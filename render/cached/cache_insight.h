#pragma once

#include <vector>

#include "common/predict/pooled_visibility.h"

namespace shadowcache {

/// What the cache says of a place before any ray is traced there.
struct CacheInsight {
    float openness = 0;       ///< open share of the sky, weighted by the cosine
    float expectedNoise = 0;  ///< standard deviation expected of the irradiance's luminance
    int items = 0;            ///< cache items found
    int regions = 0;          ///< regions that samples are drawn from
};

/// Openness of pooled items.
class OpennessMeter {
public:
    explicit OpennessMeter(const DirectionTiers& tiers);

    float measure(const PooledVisibility& pooled, const Vec3f& normal) const;

private:
    std::vector<Vec3f> baseCells_;  ///< their centres, times their solid angles
};

}  // namespace shadowcache
