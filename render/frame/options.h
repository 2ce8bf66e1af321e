#pragma once

#include <cstdint>

#include "common/math/vec.h"

namespace shadowcache {

inline constexpr int kMostSamples = 1 << 20;

struct RenderOptions {
    int width = 960;
    int height = 540;
    int samples = 64;    ///< shadow rays a camera ray
    int cameraRays = 1;  ///< camera rays a pixel; one goes through the pixel's centre
    std::uint64_t seed = 1;
    bool insight = false;  ///< keep what the cache says of each place, for the AOVs that show it
    Rgb albedo{0.5f, 0.5f, 0.5f};  ///< where the set has no vertex colours
};

/// @throws Error naming the option, the value and the range allowed
void validate(const RenderOptions& options);

}  // namespace shadowcache
