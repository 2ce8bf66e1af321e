#pragma once

#include "common/environment.h"
#include "render/cell_splits.h"
#include "render/pooled_visibility.h"

namespace shadowcache {

/// The irradiance that the counts foretell, without any ray: the control variate's integral alone,
/// with none of what samples need. [docs/estimator.md]
class CachePreview {
public:
    CachePreview(const Environment& environment, const DirectionTiers& tiers);

    /// Sum over regions of c_r (n . V_r) on a surface of unit normal `normal`.
    Rgb irradiance(const PooledVisibility& pooled, const Vec3f& normal) const;

private:
    struct Sum;
    void addBlock(int tier, std::uint32_t block, const PooledBlock* counts, float above,
                  Sum& sum) const;
    void addSplit(int tier, std::uint32_t block, const CellLight& sky, const float* c,
                  Sum& sum) const;

    const Environment& environment_;
    DirectionTiers tiers_;
    CellSplitter splitter_;
};

}  // namespace shadowcache
