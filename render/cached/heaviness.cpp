#include "render/cached/heaviness.h"

#include <algorithm>
#include <cmath>

#include "common/base/tuned.h"
#include "render/cached/neighbor_reuse.h"
#include "render/regions/cosine_integrand.h"

namespace shadowcache {

namespace {

/// Part of a pixel's standard deviation from which on a sample is heavy: lighter ones are lost in
/// the noise of all else.
SHADOWCACHE_TUNED(double, kHeavyDeviations, 0.6);

/// Share of a group that a misprediction concerns, about.
SHADOWCACHE_TUNED(double, kSharedMispredictions, 0.6);

/// The first bin ends here.
constexpr double kLeastHeaviness = 0x1p-20;
constexpr double kBinsAnOctave = 4;

/// The middle of a bin.
double heavinessOf(std::size_t bin) {
    return kLeastHeaviness * std::exp2((static_cast<double>(bin) + 0.5) / kBinsAnOctave);
}

}  // namespace

void VarianceByHeaviness::add(double heaviness, double variance, double ifReused) {
    const double bin = std::floor(
        kBinsAnOctave * std::log2(std::max(heaviness, kLeastHeaviness) / kLeastHeaviness));
    const auto i = static_cast<std::size_t>(std::clamp(bin, 0.0, kBins - 1.0));
    variance_[i] += variance;
    ifReused_[i] += ifReused;
}

void VarianceByHeaviness::add(const VarianceByHeaviness& other, double factor, double share) {
    for (std::size_t bin = 0; bin < kBins; ++bin)
        if (other.variance_[bin] > 0)
            add(factor * heavinessOf(bin), factor * share * other.variance_[bin],
                factor * share * other.ifReused_[bin]);
}

double VarianceByHeaviness::heavyFrom(double cameraRayError) const {
    // The more is reused, the less error is left, and the lighter samples are heavy: several
    // thresholds may agree with the error that they leave. From above, the first has fewest rays.
    double error = cameraRayError;
    for (const double unused : variance_) error += unused;
    const auto heavy = [&] { return std::max(kHeavy, kHeavyDeviations * std::sqrt(error)); };
    for (std::size_t bin = kBins; bin-- > 0 && heavinessOf(bin) >= heavy();)
        error += ifReused_[bin] - variance_[bin];
    return heavy();
}

VarianceByHeaviness varianceByHeaviness(const Regions& regions, const ShareRules& rules,
                                        const Brightness& brightness, double scale) {
    VarianceByHeaviness found;
    if (!(regions.lightSum > 0)) return found;
    const RegionWeights weights(regions, rules);
    const double perLight = weights.heaviness(1, brightness);
    for (const RegionGroup& group : regions.groups)
        for (int i = 0; i < kBlockCells; ++i) {
            if (!(group.deviation[i] > 0)) continue;
            const auto weight = static_cast<double>(weights.of(group, i));
            const double relative = static_cast<double>(group.deviation[i]) / scale;
            const double variance = relative * relative * weights.sum() / weight;
            const auto visible = static_cast<double>(group.calibrated[i]);
            const bool darkIsPredicted = group.visibility[i] < rules.mostlyVisible;
            const double chance = darkIsPredicted ? visible : 1 - visible;
            const double gain =
                darkIsPredicted || group.exact[i] > 0
                    ? 1 + kSharedMispredictions * (pixelsOfGroup(chance, kGroupPerFind) - 1)
                    : 1;
            found.add(perLight * static_cast<double>(group.light[i]) / weight, variance,
                      variance / gain);
        }
    return found;
}

}  // namespace shadowcache
