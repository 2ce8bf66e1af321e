#pragma once

#include <array>

#include "common/light/environment.h"
#include "common/predict/cell_splits.h"
#include "common/predict/pooled_visibility.h"

namespace shadowcache {

/// Irradiance of surfaces whose unit normals are near one.
struct IrradianceWithGradient {
    Rgb value;                      ///< at the normal itself
    std::array<Vec3f, 3> gradient;  ///< [colour]: of the irradiance by the normal

    /// At the normal + tilt.
    Rgb at(const Vec3f& tilt) const;
};

/// The irradiance that the counts foretell, without any ray: the control variate's integral alone,
/// the sum over regions of c_r (n . V_r), with none of what samples need. [docs/estimator.md]
class CachePreview {
public:
    CachePreview(const Environment& environment, const DirectionTiers& tiers);

    /// On a surface of unit normal `normal`, by the counts of several items or of one.
    Rgb irradiance(const PooledVisibility& pooled, const Vec3f& normal) const;
    Rgb irradiance(const ItemView& item, const Vec3f& normal) const;
    /// On surfaces of unit normals near `normal`, by the counts of one item.
    IrradianceWithGradient irradianceWithGradient(const ItemView& item, const Vec3f& normal) const;

private:
    const Environment& environment_;
    DirectionTiers tiers_;
    CellSplitter splitter_;
};

}  // namespace shadowcache
