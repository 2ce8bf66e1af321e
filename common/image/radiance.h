#pragma once

#include <cstddef>
#include <filesystem>

#include "common/image/image.h"

namespace shadowcache {

/// Image read for use as radiance, and what had to be mended.
struct RadianceImage {
    Image image;
    Rgb luminanceWeights{0.2126f, 0.7152f,
                         0.0722f};  ///< from the EXR's chromaticities if it has them
    std::size_t notFinite = 0;      ///< NaN and Inf texels, set to 0
    std::size_t negative = 0;       ///< texels with a negative channel, that channel set to 0
};

/// Reads radiance from OpenEXR (scan lines or tiles, one part or the first of several with colour,
/// half, float or uint channels, R G B [A], Y alone or Y RY BY, data window anywhere) or Radiance
/// HDR; told apart by content, not by name.
///
/// @throws Error naming the file and the cause
RadianceImage readRadiance(const std::filesystem::path& path);

}  // namespace shadowcache
