#include "common/import/vertex_colors.h"

#include <algorithm>
#include <cmath>

#include "common/image/srgb.h"

namespace shadowcache {

namespace {

constexpr double kGreatestByte = 255, kGreatestWord = 65535;

}  // namespace

void ColorScale::see(double value) {
    if (!std::isfinite(value)) return;
    whole_ = whole_ && value == std::floor(value);
    greatest_ = std::max(greatest_, value);
}

double ColorScale::full() const {
    if (numbers_ == ColorNumbers::bytes) return kGreatestByte;
    if (numbers_ == ColorNumbers::whole)
        return greatest_ > kGreatestByte ? kGreatestWord : kGreatestByte;
    return whole_ && greatest_ > 1 ? kGreatestByte : 1;
}

float clampedShare(double value, bool& bad) {
    if (value >= 0 && value <= 1) return static_cast<float>(value);
    bad = true;
    return value > 1 ? 1.0f : 0.0f;
}

std::size_t decodeColors(const ColorScale& scale, std::vector<Rgb>& colors) {
    const double full = scale.full();
    std::size_t badColors = 0;
    for (Rgb& color : colors) {
        bool bad = false;
        for (int k = 0; k < 3; ++k)
            color[k] = srgbToLinear(clampedShare(static_cast<double>(color[k]) / full, bad));
        badColors += bad ? 1 : 0;
    }
    return badColors;
}

}  // namespace shadowcache
