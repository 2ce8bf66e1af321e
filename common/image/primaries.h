#pragma once

#include <array>
#include <filesystem>

#include "common/image/radiance_image.h"

namespace shadowcache {

/// Gives an image the primaries that its file states: their luminance, and, where they are not Rec.
/// 709, a note.
///
/// @param primaries  x and y of red, green, blue and white
/// @throws Error naming the file and the primaries if they have no luminance
void setPrimaries(const std::filesystem::path& path, const std::array<float, 8>& primaries,
                  RadianceImage& image);

}  // namespace shadowcache
