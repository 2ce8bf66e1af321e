#pragma once

#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// Linear RGB picture, row 0 at the top.
struct Image {
    int width = 0;            ///< pixels
    int height = 0;           ///< pixels
    std::vector<Rgb> pixels;  ///< width * height, `pixels[y * width + x]`
};

}  // namespace shadowcache
