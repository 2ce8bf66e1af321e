#pragma once

#include <vector>

#include "bake/inspect/item_regions.h"
#include "common/image/image.h"

namespace shadowcache {

/// Visibility of the sky above one place by the counts of an open cache.
class SkyView {
public:
    /// @param cache     stays open as long as the view; without a memory budget
    /// @param position  world space
    /// @param normal    unit
    SkyView(const ShadowCache& cache, const Vec3d& position, const Vec3f& normal);

    /// Shares of the items that were found, in (0, 1]; they sum to 1. Empty: nothing was found.
    const std::vector<float>& weights() const { return weights_; }

    /// Prediction for one direction.
    struct Sight {
        double visible;  ///< share of the rays that reached the sky, 0 to 1
        double counted;  ///< share of the items that have rays there; 0: nothing is known
    };
    /// By the finest counts around a unit vector.
    Sight look(const Vec3d& direction) const;

    /// The hemisphere above the place in figures; means are over the part that is known.
    struct Figures {
        double known = 0;           ///< share of the hemisphere
        double visible = 0;         ///< mean visible share
        double visibleCosine = 0;   ///< the same weighted by the cosine
        double pure = 0;            ///< share where all rays agreed
        Vec3d bentNormal{0, 0, 0};  ///< mean visible direction, unit length, or zero
    };
    /// Summed over the cells of level kMaxCacheLevel.
    Figures figures() const;

    /// Lat-long picture as maps have it: +Y at the top, +Z in the middle, +X left of it.
    /// Blue is visible, amber partly, black occluded; grey is below the horizon, violet unknown.
    ///
    /// @param width  pixels, even; the height is half of it
    Image picture(int width) const;

private:
    Sight lookAtCell(std::uint32_t finestCell) const;

    Vec3d normal_;
    std::vector<ItemRegions> items_;
    std::vector<float> weights_;
};

}  // namespace shadowcache
