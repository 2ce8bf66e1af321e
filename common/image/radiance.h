#pragma once

#include <filesystem>

#include "common/image/radiance_image.h"

namespace shadowcache {

/// Reads radiance from OpenEXR (scan lines or tiles, one part or the first of several with colour,
/// half, float or uint channels, R G B [A], Y alone, Y RY BY, or the colours of a layer) or
/// Radiance HDR; the content tells which, not the name. The picture is the display window.
///
/// @throws Error naming the file and the cause
RadianceImage readRadiance(const std::filesystem::path& path);

}  // namespace shadowcache
