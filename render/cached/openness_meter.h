#pragma once

#include <vector>

#include "common/predict/pooled_visibility.h"

namespace shadowcache {

/// Openness of pooled items.
class OpennessMeter {
public:
    explicit OpennessMeter(const DirectionTiers& tiers);

    float measure(const PooledVisibility& pooled, const Vec3f& normal) const;

private:
    std::vector<Vec3f> baseCells_;  ///< their centres, times their solid angles
};

}  // namespace shadowcache
