#pragma once

#include <cstddef>

#include "common/image/image.h"

namespace shadowcache {

/// Image read for use as radiance, and the defects repaired in it.
struct RadianceImage {
    Image image;
    Rgb luminanceWeights{0.2126f, 0.7152f,
                         0.0722f};  ///< from the EXR's chromaticities if it has them
    std::size_t notFinite = 0;      ///< NaN and Inf texels, set to 0
    std::size_t negative = 0;       ///< texels with a negative channel, that channel set to 0
};

}  // namespace shadowcache
