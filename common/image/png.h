#pragma once

#include <filesystem>
#include <string>

#include "common/image/image.h"

namespace shadowcache {

/// The bytes of an 8-bit sRGB PNG of pixels * 2^exposure, clamped.
std::string encodePng(const Image& image, float exposure);

/// Writes an 8-bit sRGB PNG of pixels * 2^exposure, clamped; written beside, then renamed.
void writePng(const std::filesystem::path& path, const Image& image, float exposure);

}  // namespace shadowcache
