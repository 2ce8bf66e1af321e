#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace shadowcache {

/// Pixels of a thumbnail, about.
inline constexpr double kThumbnailPixels = 4096;

/// Width and height of a small picture of a frame, by which times and noise are estimated.
inline std::array<int, 2> thumbnailSize(int width, int height) {
    const double shrink =
        std::min(1.0, std::sqrt(kThumbnailPixels / (static_cast<double>(width) * height)));
    const auto side = [&](int whole) {
        return std::max(1, static_cast<int>(std::lround(whole * shrink)));
    };
    return {side(width), side(height)};
}

}  // namespace shadowcache
