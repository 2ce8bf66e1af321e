// What glossy surfaces reflect, without a cache: samples of the map and of the lobe.

#include "render/estimators/map_samples.h"

namespace shadowcache {

namespace {

/// Queues the samples of one point; map and lobe take turns, as the strategies of `mis` do.
void prepareGloss(const EstimatorContext& context, const GlossyPoint& glossy,
                  const SampleSlice& slice, Workspace& w) {
    const GlossyLobe& lobe = glossy.lobe;
    const std::uint64_t seed = hashWords(glossy.point.seed, RenderSalt::gloss);
    const auto turn = static_cast<std::uint32_t>(hashWords(seed, RenderSalt::glossTurn) >> 63);
    const auto weight = [&](const EnvironmentSample& s) {
        return 2 / (static_cast<float>(slice.count) * (s.density + lobe.density(s.direction)));
    };
    const auto add = [&](const EnvironmentSample& s) {
        const Rgb value = lobe.value(s.direction);
        if (value == Rgb(0.0f))
            w.samples.addZero();
        else
            w.samples.add(s.direction, s.radiance * value * weight(s));
    };
    drawFromMap(context, seed, everySecond(slice, turn), w, add);
    w.samples.endGroup();
    const SampleSlice ofLobe = everySecond(slice, 1 - turn);
    const auto u = w.numbers(context.sequence, seed, 2, ofLobe.first, ofLobe.count, ofLobe.total);
    const auto v = w.numbers(context.sequence, seed, 3, ofLobe.first, ofLobe.count, ofLobe.total);
    for (std::size_t i = 0; i < u.size(); ++i)
        add(context.environment.lookUp(lobe.sample(toUnitFloat(u[i]), toUnitFloat(v[i]))));
    w.samples.endGroup();
}

}  // namespace

void Estimator::estimateGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                              Workspace& workspace, std::span<GlossEstimate> estimates) const {
    Stopwatch watch;
    const bool dark = context_.environment.luminanceIntegral() <= 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        estimates[i] = {};
        if (dark || batch.samples == 0) continue;
        workspace.samples.clear();
        prepareGloss(context_, points[i], sliceOf(batch, points[i].point), workspace);
        workspace.setupNanoseconds += watch.sinceLast();
        Estimate sum;
        workspace.samples.trace(context_.scene, points[i].point, context_.environment, sum);
        estimates[i] = {sum.irradiance, sum.variance, sum.rays};
        workspace.traceNanoseconds += watch.sinceLast();
    }
}

}  // namespace shadowcache
