#include "render/regions/calibration.h"

#include <algorithm>
#include <cmath>

#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Weight of the counts' own prediction beside the measured share, in rays.
constexpr double kCalibrationPrior = 2;

/// Least error of the visibility that is corrected: below it nothing is to be gained, and what the
/// counts call fully visible or fully occluded stays free of noise.
constexpr double kLeastCorrection = 0.02;

/// Standard errors that a measured share must be off by to count as the cache's fault.
SHADOWCACHE_TUNED(double, kCorrectionErrors, 4);

}  // namespace

Calibration::Calibration() {
    factor_.fill(1);
    correction_.fill(0);
}

void Calibration::add(float a, bool visible) {
    const std::uint32_t bin = binOf(a, uncertaintyOf(a));
    visible_[bin] += visible;
    ++rays_[bin];
    sum_[bin] += static_cast<double>(a > 0.5f ? 1 - uncertaintyOf(a) : uncertaintyOf(a));
}

void Calibration::add(const Calibration& other) {
    for (std::size_t i = 0; i < kBins; ++i) {
        visible_[i] += other.visible_[i];
        rays_[i] += other.rays_[i];
        sum_[i] += other.sum_[i];
    }
}

void Calibration::update() {
    for (std::size_t i = 0; i < kBins; ++i) {
        if (rays_[i] == 0) continue;
        const auto rays = static_cast<double>(rays_[i]);
        const auto visible = static_cast<double>(visible_[i]);
        const double predicted = sum_[i] / rays;
        const double found = (visible + kCalibrationPrior * predicted) / (rays + kCalibrationPrior);
        const double least = static_cast<double>(kLeastUncertainty);
        const double uncertainty = i < kBinsPerSide ? found : 1 - found;
        const double predictedUncertainty = i < kBinsPerSide ? predicted : 1 - predicted;
        factor_[i] =
            static_cast<float>(std::clamp(uncertainty, least, 1 - least) / predictedUncertainty);
        const double share = std::clamp(visible / rays, 1 / (rays + 2), 1 - 1 / (rays + 2));
        const double error = std::sqrt(share * (1 - share) / rays);
        const double off = found - predicted;
        correction_[i] = std::abs(off) > std::max(kLeastCorrection, kCorrectionErrors * error)
                             ? static_cast<float>(off)
                             : 0.0f;
    }
}

}  // namespace shadowcache
