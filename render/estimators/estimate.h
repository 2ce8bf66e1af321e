#pragma once

#include <cstdint>

#include "common/math/vec.h"

namespace shadowcache {

/// Irradiance from the environment and what it took.
struct Estimate {
    Rgb irradiance{0, 0, 0};
    Rgb predicted{0, 0, 0};  ///< irradiance predicted without rays, if PointBatch::predict
    float variance = 0;    ///< of the irradiance's luminance, estimated from the samples themselves
    float covariance = 0;  ///< sum of the covariances with the other points of its pixel
    std::uint32_t rays = 0;    ///< traced for this point's own samples
    std::uint32_t reused = 0;  ///< traced to reuse what other points found
};

/// Radiance that a lobe reflects to the viewer, and what it took.
struct GlossEstimate {
    Rgb radiance{0, 0, 0};
    float variance = 0;  ///< of its luminance, estimated from the samples themselves
    std::uint32_t rays = 0;
};

}  // namespace shadowcache
