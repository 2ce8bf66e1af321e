#pragma once

#include <cstddef>

#include "common/image/image.h"

namespace shadowcache {

/// Image read for use as radiance, and the defects repaired in it.
struct RadianceImage {
    Image image;  ///< finite and non-negative
    /// Luminance of the three primaries, sum 1: from the EXR's chromaticities, else Rec. 709.
    Rgb luminanceWeights{0.2126f, 0.7152f, 0.0722f};
    std::size_t notFinite = 0;  ///< texels with NaN or Inf, set to 0
    std::size_t negative = 0;   ///< texels with a negative channel, that channel set to 0
};

}  // namespace shadowcache
