#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "common/image/image.h"

namespace shadowcache {

/// The bytes of an 8-bit sRGB PNG of pixels * 2^exposure, clamped.
///
/// @param alpha  of each pixel, by which its colour is multiplied; the PNG's is not; none: opaque
std::string encodePng(const Image& image, float exposure, std::span<const float> alpha = {});

/// Writes such a PNG beside, then renames it.
void writePng(const std::filesystem::path& path, const Image& image, float exposure,
              std::span<const float> alpha = {});

}  // namespace shadowcache
