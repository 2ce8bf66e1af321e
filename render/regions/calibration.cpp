#include "render/regions/calibration.h"

#include <algorithm>
#include <cmath>

#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Weight of the counts' own prediction beside the measured share, in rays.
constexpr double kCalibrationPrior = 2;

/// Least error of the visibility that is corrected where what the counts call fully visible or
/// fully occluded would no longer be free of noise.
constexpr double kLeastCorrection = 0.02;

/// Share of the rays predicted to be visible that are, below which counts are worth as little in
/// bins with too few rays to tell.
constexpr double kLeastFound = 0.5;

/// Standard errors that a measured share must be off by to count as the cache's fault.
SHADOWCACHE_TUNED(double, kCorrectionErrors, 4);

}  // namespace

Calibration::Calibration() {
    factor_.fill(1);
    slope_.fill(1);
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

double Calibration::lightFound() const {
    double visible = 0, predicted = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
        visible += static_cast<double>(visible_[i]);
        predicted += sum_[i];
    }
    return (visible + kCalibrationPrior) / (predicted + kCalibrationPrior);
}

void Calibration::update() {
    const double all = lightFound();
    for (std::size_t i = 0; i < kBins; ++i) {
        slope_[i] = all < kLeastFound ? static_cast<float>(all) : 1;
        offset_[i] = 0;
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
        // In proportion: where no ray is visible the counts of the whole bin are worth nothing. The
        // prior is one visible ray: in a bin of three, one that hits by chance proves nothing.
        if (all < kLeastFound) {
            slope_[i] = static_cast<float>((visible + 1) / (rays * predicted + 1 / all));
            continue;
        }
        const double measured = visible / rays;
        const double share = std::clamp(measured, 1 / (rays + 2), 1 - 1 / (rays + 2));
        const double error = std::sqrt(share * (1 - share) / rays);
        const bool darker = measured < predicted;
        const bool leavesCertain = darker == (i < kBinsPerSide);
        if (std::abs(found - predicted) <=
            std::max(leavesCertain ? 0 : kLeastCorrection, kCorrectionErrors * error))
            continue;
        slope_[i] =
            static_cast<float>(darker ? measured / predicted : (1 - measured) / (1 - predicted));
        offset_[i] = darker ? 0 : 1 - slope_[i];
    }
}

}  // namespace shadowcache
