#pragma once

#include <span>

#include "bake/inspect/item_regions.h"
#include "common/light/environment.h"

namespace shadowcache {

/// Irradiance that counts foresee, without a ray.
struct SkyLight {
    Rgb seen{0, 0, 0};        ///< with the regions as open as counted
    Rgb unshadowed{0, 0, 0};  ///< as if they were all open
};

/// Light of the environment on a surface with unit normal `normal`, from regions of its sky.
SkyLight skyLight(std::span<const CountedRegion> regions, const Vec3f& normal,
                  const Environment& environment);

}  // namespace shadowcache
