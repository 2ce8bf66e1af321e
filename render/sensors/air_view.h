#pragma once

#include <cstdint>
#include <vector>

#include "common/cache/item_table.h"
#include "common/trace/scene.h"
#include "render/sensors/sky_patches.h"

namespace shadowcache {

/// What a place sees that the cache knows nothing of, as those in the air: rays through the middle
/// of each cell of Environment::kLevel that is above its horizon.
struct AirView {
    /// An item that rays met.
    struct Met {
        std::uint32_t item;
        float share;  ///< of the radiance that leaves it in the irradiance of the place [sr]
    };

    /// By cell: its share in the irradiance for each unit of radiance where the ray reaches the sky
    /// [sr]; 0 elsewhere.
    std::vector<float> sky;
    std::vector<Met> met;  ///< none without items
};

/// Where the rays of a place start: off it by some roundings, so that a surface that it lies on is
/// not met. Relative to the mesh's origin.
///
/// @param position  world space
/// @param normal    unit
Vec3f rayStartInAir(const Scene& scene, const Vec3d& position, const Vec3f& normal);

/// Looks around at one place after the other. One object a thread.
class AirViewer {
public:
    /// @param items  of the cache whose items the rays meet; null: the sky alone is wanted
    AirViewer(const Scene& scene, const PatchCosines& cosines, const ItemTable* items);

    /// @param position  world space
    /// @param normal    unit
    /// @return valid until the next call
    const AirView& look(const Vec3d& position, const Vec3f& normal);

private:
    void trace(const std::uint32_t* cells, int count);

    const Scene& scene_;
    const PatchCosines& cosines_;
    const ItemTable* const items_;
    std::vector<float> shares_;  ///< by cell, of what is seen there [sr]
    Vec3f start_{0};             ///< relative to the mesh's origin
    AirView view_;
    double known_ = 0, unknown_ = 0;  ///< shares of surfaces with an item, and without
};

}  // namespace shadowcache
