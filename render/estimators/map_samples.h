#pragma once

#include "render/estimators/estimator.h"
#include "render/estimators/full_precision.h"

namespace shadowcache {

/// The map, drawn from in proportion to its luminance, which must be above 0 somewhere.
struct WholeMap {
    const Environment& environment;

    EnvironmentSample sample(double u, float jitterX, float jitterY) const {
        return environment.sample(u, jitterX, jitterY);
    }
    float density(const EnvironmentSample& s) const { return s.density; }
};

/// Draws a slice of a sequence's samples from `light`, such as WholeMap, and hands each to `use`.
/// Takes dimensions 0 and 1 of the sequence of `seed`.
template <class Light, class Use>
void drawFromMap(const EstimatorContext& context, std::uint64_t seed, const SampleSlice& slice,
                 Workspace& w, const Light& light, const Use& use) {
    const auto u = w.numbers(context.sequence, seed, 0, slice.first, slice.count);
    const auto v = w.numbers(context.sequence, seed, 1, slice.first, slice.count);
    for (std::size_t k = 0; k < u.size(); ++k) {
        const std::uint64_t number = slice.first + k;
        const auto jitter =
            static_cast<std::uint32_t>(hashWords(seed, RenderSalt::texelPlace, number) >> 32);
        use(light.sample(fullPrecision(u[k], seed, number), toUnitFloat(v[k]),
                         toUnitFloat(jitter)));
    }
}

/// Those of a slice whose numbers are `turn` (0 or 1) more than an even number: the share of one of
/// two strategies that take turns.
inline SampleSlice everySecond(const SampleSlice& slice, std::uint32_t turn) {
    const std::uint32_t first = (slice.first + 1 - turn) / 2;
    const std::uint32_t end =
        (slice.first + static_cast<std::uint32_t>(slice.count) + 1 - turn) / 2;
    return {first, static_cast<int>(end - first)};
}

}  // namespace shadowcache
