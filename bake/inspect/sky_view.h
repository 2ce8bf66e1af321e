#pragma once

#include <vector>

#include "bake/inspect/item_regions.h"
#include "common/image/image.h"

namespace shadowcache {

/// What an open cache knows of the sky over one place, pooled as the renderer pools it.
class SkyView {
public:
    /// @param position  world space
    /// @param normal    unit
    SkyView(const ShadowCache& cache, const Vec3d& position, const Vec3f& normal);

    /// Shares of the items that were found, in [0, 1]; they sum to 1.
    const std::vector<float>& weights() const { return weights_; }

    /// What the cache says of one direction.
    struct Sight {
        double open;     ///< share of the rays that reached the sky, 0 to 1
        double counted;  ///< share of the items that have rays there; 0: nothing is known
    };
    Sight look(const Vec3d& direction) const;

    /// The hemisphere above the place in figures; means are over the part that is known.
    struct Figures {
        double known = 0;           ///< share of the hemisphere
        double open = 0;            ///< mean open share
        double openCosine = 0;      ///< the same weighted by the cosine: of a constant sky's light
        double pure = 0;            ///< share where all rays agreed
        Vec3d bentNormal{0, 0, 0};  ///< mean visible direction, unit length, or zero
    };
    Figures figures() const;

    /// Lat-long picture as maps have it: +Y at the top, +Z in the middle, +X left of it.
    /// Blue is open, amber partly, black hidden; grey is below the horizon, violet unknown.
    Image picture(int width) const;

private:
    Sight lookAtCell(std::uint32_t finestCell) const;

    Vec3d normal_;
    std::vector<ItemRegions> items_;
    std::vector<float> weights_;
};

}  // namespace shadowcache
