#pragma once

#include <span>

#include "bake/inspect/item_regions.h"
#include "common/light/environment.h"

namespace shadowcache {

/// Irradiance that counts predict [radiance sr].
struct SkyLight {
    Rgb seen{0, 0, 0};        ///< with the counted visibility
    Rgb unshadowed{0, 0, 0};  ///< as if everything were visible
};

/// Light of the environment on a surface with unit normal `normal`, from regions with d > 0.
SkyLight skyLight(std::span<const CountedRegion> regions, const Vec3f& normal,
                  const Environment& environment);

}  // namespace shadowcache
