// The estimators that know no visibility: uniform, cosine, environment and their combination.

#include <algorithm>
#include <cmath>

#include "common/base/sequence.h"
#include "render/estimators/basic_estimators.h"
#include "render/estimators/hemisphere.h"

namespace shadowcache {

namespace {

/// Full-precision number from a stratified word: its lower bits come from a hash.
double refine(std::uint32_t word, std::uint64_t seed, int i) {
    const std::uint64_t low = hashWords(seed, 77, static_cast<std::uint64_t>(i)) >> 43;
    return (static_cast<double>(word) + static_cast<double>(low) * 0x1p-21) * 0x1p-32;
}

class Uniform final : public PointEstimator {
    using PointEstimator::PointEstimator;

    Rgb prepare(const ShadingPoint& point, int samples, Workspace& w) const override {
        const auto u = w.numbers(context_.sequence, point.seed, 0, samples);
        const auto v = w.numbers(context_.sequence, point.seed, 1, samples);
        for (std::size_t i = 0; i < u.size(); ++i) {
            const Vec3f direction =
                aroundNormal(point.normal, toUnitFloat(u[i]), toUnitFloat(v[i]));
            const float cosine = std::max(0.0f, direction.dot(point.normal));
            const float weight = 2 * static_cast<float>(kPi) * cosine / static_cast<float>(samples);
            w.samples.add(direction, context_.environment.radiance(direction) * weight);
        }
        w.samples.endGroup();
        return {0, 0, 0};
    }
};

/// Half or all of the samples of `mis`: `environmentSamples` from the map, `cosineSamples` from the
/// cosine, weighted by the balance heuristic. [Veach & Guibas 1995]
Rgb prepareMixture(const EstimatorContext& context, const ShadingPoint& point,
                   int environmentSamples, int cosineSamples, Workspace& w) {
    const Environment& environment = context.environment;
    const Vec3f n = point.normal;
    const auto ne = static_cast<float>(environmentSamples), nc = static_cast<float>(cosineSamples);
    if (environment.totalPower() <= 0) return {0, 0, 0};
    const auto u = w.numbers(context.sequence, point.seed, 0, environmentSamples);
    const auto v = w.numbers(context.sequence, point.seed, 1, environmentSamples);
    for (int i = 0; i < environmentSamples; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const auto jitter = static_cast<std::uint32_t>(hashWords(point.seed, 78, k) >> 32);
        const EnvironmentSample s =
            environment.sample(refine(u[k], point.seed, i), toUnitFloat(v[k]), toUnitFloat(jitter));
        const float cosine = s.direction.dot(n);
        if (cosine <= 0) {
            w.samples.addZero();
            continue;
        }
        const float density = ne * s.density + nc * cosine / static_cast<float>(kPi);
        w.samples.add(s.direction, s.radiance * (cosine / density));
    }
    w.samples.endGroup();
    const auto a = w.numbers(context.sequence, point.seed, 2, cosineSamples);
    const auto b = w.numbers(context.sequence, point.seed, 3, cosineSamples);
    for (std::size_t i = 0; i < a.size(); ++i) {
        const float cosine = std::sqrt(1 - toUnitFloat(a[i]));
        const Vec3f direction = aroundNormal(n, cosine, toUnitFloat(b[i]));
        const EnvironmentSample s = environment.lookUp(direction);
        const float density = ne * s.density + nc * cosine / static_cast<float>(kPi);
        w.samples.add(direction, s.radiance * (cosine / density));
    }
    w.samples.endGroup();
    return {0, 0, 0};
}

class Cosine final : public PointEstimator {
    using PointEstimator::PointEstimator;
    Rgb prepare(const ShadingPoint& point, int samples, Workspace& w) const override {
        return prepareMixture(context_, point, 0, samples, w);
    }
};

class MapOnly final : public PointEstimator {
    using PointEstimator::PointEstimator;
    Rgb prepare(const ShadingPoint& point, int samples, Workspace& w) const override {
        return prepareMixture(context_, point, samples, 0, w);
    }
};

class Mis final : public PointEstimator {
    using PointEstimator::PointEstimator;
    Rgb prepare(const ShadingPoint& point, int samples, Workspace& w) const override {
        return prepareMixture(context_, point, (samples + 1) / 2, samples / 2, w);
    }
};

}  // namespace

std::unique_ptr<Estimator> makeUniform(const EstimatorContext& context) {
    return std::make_unique<Uniform>(context);
}
std::unique_ptr<Estimator> makeCosine(const EstimatorContext& context) {
    return std::make_unique<Cosine>(context);
}
std::unique_ptr<Estimator> makeEnvironment(const EstimatorContext& context) {
    return std::make_unique<MapOnly>(context);
}
std::unique_ptr<Estimator> makeMis(const EstimatorContext& context) {
    return std::make_unique<Mis>(context);
}

}  // namespace shadowcache
