#include "common/image/false_color.h"

#include <algorithm>
#include <array>

#include "common/image/srgb.h"

namespace shadowcache {

Rgb falseColor(double value) {
    static constexpr std::array<std::array<int, 3>, 9> kStops{{{68, 1, 84},
                                                               {71, 44, 122},
                                                               {59, 81, 139},
                                                               {44, 113, 142},
                                                               {33, 144, 141},
                                                               {39, 173, 129},
                                                               {92, 200, 99},
                                                               {170, 220, 50},
                                                               {253, 231, 37}}};
    const double place = std::clamp(value, 0.0, 1.0) * (kStops.size() - 1);
    const std::size_t stop = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
    const double t = place - static_cast<double>(stop);
    Rgb color;
    for (std::size_t c = 0; c < 3; ++c)
        color[static_cast<int>(c)] = srgbToLinear(
            static_cast<float>((kStops[stop][c] * (1 - t) + kStops[stop + 1][c] * t) / 255));
    return color;
}

}  // namespace shadowcache
