#include "bake/inspect/sky_light.h"

#include <algorithm>

namespace shadowcache {

namespace {

/// Integral of L (n . w)+ over a cell. Cells on the horizon are split as far as the map's table
/// goes; what is left there counts by its mean.
Rgb cellLight(const Environment& environment, const Vec3f& normal, int level, std::uint32_t cell) {
    const CellMoments& moments = environment.cells(level, cell / CellMoments::kSize);
    const std::size_t i = cell % CellMoments::kSize;
    const float height = moments.axis[0][i] * normal.x + moments.axis[1][i] * normal.y +
                         moments.axis[2][i] * normal.z;
    if (height <= -moments.sinRadius[i]) return Rgb(0.0f);
    if (height < moments.sinRadius[i] && level < Environment::kLevel) {
        Rgb sum(0.0f);
        for (std::uint32_t k = 0; k < 4; ++k)
            sum += cellLight(environment, normal, level + 1, 4 * cell + k);
        return sum;
    }
    Rgb light;
    for (int c = 0; c < 3; ++c)
        light[c] = std::max(0.0f, moments.firstMoment[c][0][i] * normal.x +
                                      moments.firstMoment[c][1][i] * normal.y +
                                      moments.firstMoment[c][2][i] * normal.z);
    return light;
}

}  // namespace

SkyLight skyLight(std::span<const CountedRegion> regions, const Vec3f& normal,
                  const Environment& environment) {
    SkyLight light;
    for (const CountedRegion& region : regions) {
        const Rgb whole = cellLight(environment, normal, region.level, region.cell);
        light.unshadowed += whole;
        light.seen += whole * static_cast<float>(region.share());
    }
    return light;
}

}  // namespace shadowcache
