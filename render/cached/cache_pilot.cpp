#include "render/cached/cache_pilot.h"

#include "common/base/tuned.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"

namespace shadowcache {

namespace {

/// Rays at each place.
SHADOWCACHE_TUNED(int, kPilotRays, 64);

}  // namespace

std::uint64_t PilotRays::trace(const EstimatorContext& context, const ShadingPoint& point,
                               const Regions& regions, LightSamples& samples, Calibration& found) {
    regions_.clear();
    double sums[2] = {0, 0};
    for (const RegionGroup& group : regions.groups)
        for (std::uint32_t i = 0; i < kBlockCells; ++i) {
            if (!(group.deviation[i] > 0)) continue;
            regions_.push_back({group.level,
                                group.firstCell + i,
                                group.posterior[i],
                                {group.deviation[i], group.light[i]}});
            for (int k = 0; k < 2; ++k) sums[k] += static_cast<double>(regions_.back().weight[k]);
        }
    samples.clear();
    posteriors_.clear();
    for (int k = 0; k < 2 && sums[k] > 0; ++k)
        draw(context.environment, point, k, sums[k], samples);
    Estimate unused;
    samples.trace(context.scene, point, context.environment, unused);
    for (std::size_t i = 0; i < samples.size(); ++i) found.add(posteriors_[i], samples.visible(i));
    return unused.rays;
}

/// Queues half of the rays, in proportion to weight[k] of the regions.
void PilotRays::draw(const Environment& environment, const ShadingPoint& point, int k, double sum,
                     LightSamples& samples) {
    const int each = kPilotRays / 2;
    int j = 0;
    const auto numberOf = [&](int dimension) {
        return hashWords(point.seed, RenderSalt::pilotRay,
                         static_cast<std::uint64_t>(j) * 8 + static_cast<std::uint64_t>(k) * 4 +
                             static_cast<std::uint64_t>(dimension));
    };
    const auto placeOf = [&] { return sum * (j + toUnit(numberOf(0))) / each; };
    double below = 0, next = placeOf();
    for (const Region& r : regions_) {
        below += static_cast<double>(r.weight[k]);
        for (; j < each && next < below; ++j, next = placeOf()) {
            const std::uint64_t h = numberOf(1);
            const EnvironmentSample s = environment.sampleCell(
                r.level, r.cell, toUnit(numberOf(2)), toUnitFloat(static_cast<std::uint32_t>(h)),
                toUnitFloat(static_cast<std::uint32_t>(h >> 32)));
            if (s.direction.dot(point.normal) <= 0) continue;
            samples.add(s.direction, Rgb(0, 0, 0));
            posteriors_.push_back(r.posterior);
        }
    }
}

}  // namespace shadowcache
