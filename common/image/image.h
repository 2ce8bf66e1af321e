#pragma once

#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// Linear RGB picture, row 0 at the top, `pixels[y * width + x]`.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<Rgb> pixels;
};

}  // namespace shadowcache
