#include "render/regions/sample_budget.h"

#include <algorithm>
#include <cmath>

#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Fewest samples of a point, in means: a place predicted quiet may be mispredicted.
SHADOWCACHE_TUNED(double, kLeastBudget, 0.25);
/// Most samples of a point, in means.
SHADOWCACHE_TUNED(double, kMostBudget, 16);

double need(const PredictedNoise& noise) {
    return noise.deviation / noise.scale;
}

}  // namespace

double SampleBudget::samplesFor(double need) const {
    return std::clamp(need * perNeed_, least_, most_);
}

SampleBudget::SampleBudget(std::span<const PredictedNoise> places, int samples) {
    const double wanted = samples;
    least_ = wanted * kLeastBudget;
    most_ = wanted * kMostBudget;
    const auto count = static_cast<double>(std::max<std::size_t>(places.size(), 1));
    // The mean grows with perNeed_: halve the interval.
    double low = 0, high = 1;
    const auto meanSamples = [&](double perNeed) {
        perNeed_ = perNeed;
        double sum = 0;
        for (const PredictedNoise& p : places) sum += samplesFor(need(p)) / count;
        return sum;
    };
    while (meanSamples(high) < wanted && high < 1e18) high *= 4;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (meanSamples(middle) < wanted ? low : high) = middle;
    }
    perNeed_ = high;
    predictedError_ = 0;
    for (const PredictedNoise& p : places)
        predictedError_ += need(p) * need(p) / samplesFor(need(p)) / count;
}

double SampleBudget::samplesOf(const PredictedNoise& noise) const {
    return samplesFor(need(noise));
}

}  // namespace shadowcache
