#pragma once

#include "render/estimators/map_samples.h"

namespace shadowcache {

/// Queues the samples of a glossy point: those of the light and those of its lobe take turns, as
/// the strategies of `mis` do, weighted by the balance heuristic. With a cache:
/// render/cached/lobe_light.h; of emitters: emitter_light.h.
///
/// @param light  sample(u, jitterX, jitterY) draws a direction to the light, and density(s) tells
///               with which density it would have drawn a direction that
///               Environment::lookUp() found
template <class Light>
void queueGloss(const EstimatorContext& context, const GlossyPoint& glossy,
                const SampleSlice& slice, const Light& light, Workspace& w) {
    const GlossyLobe& lobe = glossy.lobe;
    const std::uint64_t seed = hashWords(glossy.point.slot.seed, RenderSalt::gloss);
    const auto turn = static_cast<std::uint32_t>(hashWords(seed, RenderSalt::glossTurn) >> 63);
    const auto add = [&](const EnvironmentSample& s) {
        const Rgb value = lobe.value(s.direction);
        if (value == Rgb(0.0f)) return w.samples.addZero();
        const float density = s.density + lobe.density(s.direction);
        w.samples.add(s.direction,
                      s.radiance * value * (2 / (static_cast<float>(slice.count) * density)));
    };
    drawFromMap(context, seed, everySecond(slice, turn), w, light, add);
    w.samples.endGroup();
    const SampleSlice ofLobe = everySecond(slice, 1 - turn);
    const auto u = w.numbers(context.sequence, seed, 2, ofLobe.first, ofLobe.count);
    const auto v = w.numbers(context.sequence, seed, 3, ofLobe.first, ofLobe.count);
    for (std::size_t i = 0; i < u.size(); ++i) {
        EnvironmentSample s =
            context.environment.lookUp(lobe.sample(toUnitFloat(u[i]), toUnitFloat(v[i])));
        s.density = light.density(s);
        add(s);
    }
    w.samples.endGroup();
}

/// Traces the samples that were queued of the point at a place.
GlossEstimate traceGloss(const EstimatorContext& context, const SetPlace& place, Workspace& w);

}  // namespace shadowcache
