#include "render/regions/lobe_match.h"

#include <algorithm>

#include "common/predict/lanes.h"

namespace shadowcache {

namespace {

/// Misfit from which on a lobe is none of the cluster's.
constexpr float kWorstMatch = 0.5f;

float sumOfProducts(const float* a, const float* b) {
    alignas(64) float product[GlossyLobe::kLanes];
    for (int i = 0; i < GlossyLobe::kLanes; ++i) product[i] = a[i] * b[i];
    return sumOf(product);
}

}  // namespace

LobeMatch::LobeMatch(const GlossyLobe& central) {
    for (int i = 0; i < kLanes; ++i) {
        const int row = i / 4, column = i % 4;
        const Vec3f w = central.sample((static_cast<float>(column) + 0.5f) / 4,
                                       (static_cast<float>(row) + 0.5f) / 4);
        for (int k = 0; k < 3; ++k) direction_[k][i] = w[k];
    }
    central.values(direction_, value_);
}

LobeMatch::Fit LobeMatch::fit(const GlossyLobe& lobe) const {
    alignas(64) float other[3][kLanes];
    lobe.values(direction_, other);
    Fit fit;
    float all = 0, common = 0;
    for (int k = 0; k < 3; ++k) {
        const float both = sumOfProducts(value_[k], other[k]);
        const float own = sumOfProducts(value_[k], value_[k]);
        fit.factor[k] = own > 0 ? std::max(0.0f, both / own) : 0.0f;
        all += sumOfProducts(other[k], other[k]);
        common += fit.factor[k] * both;
    }
    fit.misfit = all > 0 ? std::max(0.0f, 1 - common / all) : 0.0f;
    if (fit.misfit > kWorstMatch) fit.factor = Rgb(0.0f);
    return fit;
}

}  // namespace shadowcache
