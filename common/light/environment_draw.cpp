// Drawing directions from an environment.

#include <algorithm>
#include <cmath>

#include "common/light/environment.h"
#include "common/light/light_steps.h"

namespace shadowcache {

namespace {

/// The last place that is drawn, before kNoStep.
constexpr double kLastPlace = 4294967294.0;

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
    __builtin_prefetch(&grainBegin_[firstGrain_[c]]);
    __builtin_prefetch(&grains_[firstGrain_[c]]);
    return {std::min(inCell * kSteps, kLastPlace), c, 0, 0,
            static_cast<float>(cellSize / (end - begin))};
}

void Environment::findGrain(Draw& draw) const noexcept {
    const std::uint32_t first = firstGrain_[draw.cell], end = firstGrain_[draw.cell + 1];
    const std::uint32_t k = first + lastAtMost(&grainBegin_[first], end - first,
                                               static_cast<std::uint32_t>(draw.place));
    const double steps = stepsOf(grainBegin_.data(), k, end);
    const double inGrain = (draw.place - static_cast<double>(grainBegin_[k])) / steps;
    draw.place = std::clamp(inGrain * kSteps, 0.0, kLastPlace);
    draw.grain = grains_[k];
    draw.share *= static_cast<float>(steps / kSteps);
    map_->prefetch(draw.grain);
}

void Environment::findTexel(Draw& draw) const noexcept {
    draw.texel = map_->texelAtStep(draw.grain, static_cast<std::uint32_t>(draw.place));
    map_->prefetchTexel(draw.texel);
}

EnvironmentSample Environment::finishDraw(const Draw& draw, float jitterX,
                                          float jitterY) const noexcept {
    const EnvironmentMap::Texel& texel = map_->texel(draw.texel);
    return {toWorld(map_->placeIn(draw.texel, jitterX, jitterY)), texel.radiance * gain_,
            texel.density * draw.share, draw.cell, draw.texel};
}

Environment::Draw Environment::startDraw(int level, std::uint32_t cell, double u) const noexcept {
    const int shift = 2 * (kLevel - level);
    return startDraw(cell << shift, (cell + 1) << shift, u);
}

EnvironmentSample Environment::sampleCell(int level, std::uint32_t cell, double u, float jitterX,
                                          float jitterY) const noexcept {
    Draw draw = startDraw(level, cell, u);
    findGrain(draw);
    findTexel(draw);
    return finishDraw(draw, jitterX, jitterY);
}

EnvironmentSample Environment::sample(double u, float jitterX, float jitterY) const noexcept {
    Draw draw = startDraw(std::uint32_t{0}, cellCount(kLevel), u);
    findGrain(draw);
    findTexel(draw);
    return finishDraw(draw, jitterX, jitterY);
}

}  // namespace shadowcache
