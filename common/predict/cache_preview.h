#pragma once

#include <array>

#include "common/light/environment.h"
#include "common/predict/cell_splits.h"
#include "common/predict/pooled_visibility.h"

namespace shadowcache {

/// Noise of a cell, as a share of the place's own light, from which on a preview splits it. In
/// bright places that is more than samples need.
inline constexpr float kLeastPreviewShare = 8e-3f;

/// Irradiance on a surface, and its rotational gradient. [Ward & Heckbert 1992]
struct IrradianceWithGradient {
    Rgb value;                      ///< at the normal
    std::array<Vec3f, 3> gradient;  ///< [colour]: derivative of the irradiance by the normal

    /// First-order irradiance at the unit normal `normal + tilt`, not below 0.
    Rgb at(const Vec3f& tilt) const;
};

/// The irradiance that the counts predict, without rays: the control variate's integral alone, the
/// sum over regions of c_r (n . V_r). [docs/estimator.md] Immutable, thread-safe. Irradiance is in
/// the units of the environment's radiance times sr.
class CachePreview {
public:
    /// @param environment  outlives the preview
    /// @param tiers        of the cache: header().tiers()
    /// @param leastShare   noise of a cell, as a share of the place's own light, from which on it
    ///                     is split: above 0; more is rougher and faster
    CachePreview(const Environment& environment, const DirectionTiers& tiers,
                 float leastShare = kLeastPreviewShare);

    /// On a surface of unit normal `normal`, by the counts of several items.
    Rgb irradiance(const PooledVisibility& pooled, const Vec3f& normal) const;
    /// On a surface of unit normal `normal`, by the counts of one item; its weight does not matter.
    Rgb irradiance(const ItemView& item, const Vec3f& normal) const;
    /// The same with its gradient, in which cells on the horizon count as far as they are above it.
    IrradianceWithGradient irradianceWithGradient(const ItemView& item, const Vec3f& normal) const;

private:
    const Environment& environment_;
    DirectionTiers tiers_;
    CellSplitter splitter_;
    float leastShare_;
};

}  // namespace shadowcache
