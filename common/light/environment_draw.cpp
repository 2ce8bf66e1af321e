// Drawing directions from an environment.

#include <algorithm>
#include <cmath>

#include "common/light/environment.h"

namespace shadowcache {

namespace {

/// Number of the last of `count` (>= 1) ascending values that is at most x; 0 if none is. Without
/// branches, which no processor could foresee.
template <class T>
std::uint32_t lastAtMost(const T* values, std::uint32_t count, T x) {
    std::uint32_t found = 0;
    for (std::uint32_t left = count; left > 1;) {
        const std::uint32_t half = left / 2;
        found += half * static_cast<std::uint32_t>(values[found + half] <= x);
        left -= half;
    }
    return found;
}

}  // namespace

Environment::Draw Environment::startDraw(std::uint32_t first, std::uint32_t last,
                                         double u) const noexcept {
    const double begin = cellCdf_[first], end = cellCdf_[last];
    const double x = begin + u * (end - begin);
    std::uint32_t c = first;
    if (last - first > 1) {
        std::uint32_t from = first, to = last;
        if (last - first == cellCount(kLevel)) {
            const auto g =
                std::min(static_cast<std::size_t>(x / end * static_cast<double>(guide_.size() - 1)),
                         guide_.size() - 2);
            from = guide_[g];
            to = guide_[g + 1] + 1;
        }
        c = from + lastAtMost(&cellCdf_[from], to - from, x);
    }
    while (c + 1 < last && cellCdf_[c + 1] <= cellCdf_[c]) ++c;  // never a dark cell
    while (c > first && cellCdf_[c + 1] <= cellCdf_[c]) --c;
    const double cellSize = cellCdf_[c + 1] - cellCdf_[c];
    const double inCell = std::clamp((x - cellCdf_[c]) / cellSize, 0.0, 1.0);
    const auto step = static_cast<std::uint32_t>(std::min(inCell * 4294967296.0, 4294967294.0));
    const auto texels = texelsOf(c);
    __builtin_prefetch(&texelBegin_[texels[0]]);
    __builtin_prefetch(&texelBegin_[(texels[0] + texels[1]) / 2]);
    return {c, step, 0, static_cast<float>(cellSize / (end - begin))};
}

void Environment::findTexel(Draw& draw) const noexcept {
    const auto texels = texelsOf(draw.cell);
    draw.texel = texels[0] + lastAtMost(&texelBegin_[texels[0]], texels[1] - texels[0], draw.step);
    __builtin_prefetch(&sorted_[draw.texel]);
}

EnvironmentSample Environment::finishDraw(const Draw& draw, float jitterX,
                                          float jitterY) const noexcept {
    const double share = texelShare(draw.texel, texelsOf(draw.cell)[1]);
    const std::uint32_t texel = sorted_[draw.texel].index;
    const std::size_t y = texel / width_, column = texel % width_;
    const float cosTop = rowCos_[y], cosBottom = rowCos_[y + 1];
    const float cosPolar = cosTop + (cosBottom - cosTop) * jitterY;
    const float sinPolar = std::sqrt(std::max(0.0f, 1 - cosPolar * cosPolar));
    const float texelWidth = static_cast<float>(2 * kPi) / static_cast<float>(width_);
    // Turn back from the texel's border by less than 0.007 rad: three terms give 1e-10.
    const float d = texelWidth * jitterX;
    const float sinD = d * (1 - d * d / 6), cosD = 1 - d * d / 2;
    EnvironmentSample sample;
    sample.direction = {sinPolar * (columnSin_[column] * cosD - columnCos_[column] * sinD),
                        cosPolar,
                        sinPolar * (columnCos_[column] * cosD + columnSin_[column] * sinD)};
    sample.radiance = sorted_[draw.texel].radiance;
    sample.cell = draw.cell;
    sample.texel = texel;
    sample.density = static_cast<float>(static_cast<double>(draw.cellShare) * share /
                                        static_cast<double>(texelWidth * (cosTop - cosBottom)));
    return sample;
}

Environment::Draw Environment::startDraw(int level, std::uint32_t cell, double u) const noexcept {
    const int shift = 2 * (kLevel - level);
    return startDraw(cell << shift, (cell + 1) << shift, u);
}

EnvironmentSample Environment::sampleCell(int level, std::uint32_t cell, double u, float jitterX,
                                          float jitterY) const noexcept {
    Draw draw = startDraw(level, cell, u);
    findTexel(draw);
    return finishDraw(draw, jitterX, jitterY);
}

EnvironmentSample Environment::sample(double u, float jitterX, float jitterY) const noexcept {
    Draw draw = startDraw(std::uint32_t{0}, cellCount(kLevel), u);
    findTexel(draw);
    return finishDraw(draw, jitterX, jitterY);
}

}  // namespace shadowcache
