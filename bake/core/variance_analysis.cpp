#include "bake/core/variance_analysis.h"

#include <algorithm>
#include <cmath>

namespace shadowcache {

double VarianceAnalysis::gain() const {
    const double all = mean * (1 - mean);
    return std::sqrt(all) - std::sqrt(std::clamp(all - directions, 0.0, all));
}

VarianceAnalysis analyseVariance(std::span<const Count> cells, const OriginPairs& pairs) {
    /// Ordered pairs of rays, and how many of them are visible both.
    struct Pairs {
        double counted = 0, visible = 0;
        double share() const { return visible / counted; }
    };
    const auto pairsOf = [](double rays) { return rays * (rays - 1); };
    Pairs sameCell;
    double rays = 0, visible = 0;
    for (const Count& cell : cells) {
        sameCell.counted += pairsOf(cell.rays());
        sameCell.visible += pairsOf(cell.visible());
        rays += cell.rays();
        visible += cell.visible();
    }
    const Pairs sameOrigin{static_cast<double>(pairs.counted), static_cast<double>(pairs.visible)};
    const Pairs neither{pairsOf(rays) - sameCell.counted - sameOrigin.counted,
                        pairsOf(visible) - sameCell.visible - sameOrigin.visible};
    if (!(sameCell.counted > 0 && sameOrigin.counted > 0 && neither.counted > 0)) return {};
    return {visible / rays, sameCell.share() - neither.share(),
            sameOrigin.share() - neither.share()};
}

}  // namespace shadowcache
