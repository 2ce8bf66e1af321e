#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/image/image.h"

namespace shadowcache {

/// Image read for use as radiance, and the defects repaired in it.
struct RadianceImage {
    Image image;  ///< finite and non-negative
    /// Luminance of the three primaries, sum 1: from the EXR's chromaticities, else Rec. 709.
    Rgb luminanceWeights{0.2126f, 0.7152f, 0.0722f};
    /// Of the primaries and white, x and y of each, where they are not Rec. 709: what is lit by the
    /// image has its primaries.
    std::optional<std::array<float, 8>> chromaticities;
    std::size_t notANumber = 0;  ///< texels with NaN, set to 0
    /// Texels with a channel of +Inf, set to 65504, or to the greatest number of the file if that
    /// is higher.
    std::size_t infinite = 0;
    std::size_t negative = 0;  ///< texels with a channel below 0, that channel set to 0
    /// What was chosen, repaired or left out, each a line for people; empty: nothing.
    std::vector<std::string> notes;
};

}  // namespace shadowcache
