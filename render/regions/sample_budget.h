#pragma once

#include <span>

namespace shadowcache {

/// Noise that is expected of a place before any of its rays is traced.
struct PredictedNoise {
    double deviation;  ///< standard deviation of one sample [irradiance]
    double scale;      ///< irradiance that it is relative to, above 0
};

/// Neyman allocation: shares a frame's samples out by the relative noise expected of each place.
/// The shares depend on predictions alone, so the estimates stay unbiased. [docs/estimator.md]
class SampleBudget {
public:
    /// Plans for `samples` a place, on average over places like these. No place gets less than a
    /// quarter or more than 16 times that.
    SampleBudget(std::span<const PredictedNoise> places, int samples);

    /// Samples of a place; below 1, the chance of one.
    double samplesOf(const PredictedNoise& noise) const;

    /// relMSE that the budget leads to on the places it was made for.
    double predictedError() const { return predictedError_; }

private:
    double samplesFor(double need) const;

    double least_ = 1, most_ = 1;
    double perNeed_ = 0;
    double predictedError_ = 0;
};

}  // namespace shadowcache
