// The estimators that use no visibility: uniform, cosine, environment and their combination.

#include <algorithm>
#include <cmath>

#include "common/random/sequence.h"
#include "render/estimators/basic_estimators.h"
#include "render/estimators/hemisphere.h"
#include "render/estimators/map_samples.h"

namespace shadowcache {

namespace {

class Uniform final : public PointEstimator {
    using PointEstimator::PointEstimator;

    Rgb prepare(const ShadingPoint& point, const SampleSlice& slice, Workspace& w) const override {
        const auto u = w.numbers(context_.sequence, point.slot.seed, 0, slice.first, slice.count);
        const auto v = w.numbers(context_.sequence, point.slot.seed, 1, slice.first, slice.count);
        for (std::size_t i = 0; i < u.size(); ++i) {
            const Vec3f direction =
                aroundNormal(point.place.normal, toUnitFloat(u[i]), toUnitFloat(v[i]));
            const float cosine = std::max(0.0f, direction.dot(point.place.normal));
            const float weight =
                2 * static_cast<float>(kPi) * cosine / static_cast<float>(slice.count);
            w.samples.add(direction, context_.environment.radiance(direction) * weight);
        }
        w.samples.endGroup();
        return {0, 0, 0};
    }
};

/// Samples of one strategy or of two, each with a sequence of its own, weighted by the balance
/// heuristic. [Veach & Guibas 1995]
class Mixture : public PointEstimator {
public:
    /// @param environmentShare, cosineShare  of a point's samples, on average; their sum is 1
    Mixture(const EstimatorContext& context, float environmentShare, float cosineShare)
        : PointEstimator(context), environmentShare_(environmentShare), cosineShare_(cosineShare) {}

protected:
    void addEnvironmentSamples(const ShadingPoint& point, const SampleSlice& slice, float samples,
                               Workspace& w) const {
        const WholeMap map{context_.environment};
        drawFromMap(context_, point.slot.seed, slice, w, map, [&](const EnvironmentSample& s) {
            const float cosine = s.direction.dot(point.place.normal);
            if (cosine > 0)
                w.samples.add(s.direction,
                              s.radiance * (cosine / density(s.density, cosine, samples)));
            else
                w.samples.addZero();
        });
        w.samples.endGroup();
    }

    void addCosineSamples(const ShadingPoint& point, const SampleSlice& slice, float samples,
                          Workspace& w) const {
        const auto a = w.numbers(context_.sequence, point.slot.seed, 2, slice.first, slice.count);
        const auto b = w.numbers(context_.sequence, point.slot.seed, 3, slice.first, slice.count);
        for (std::size_t i = 0; i < a.size(); ++i) {
            const float cosine = std::sqrt(1 - toUnitFloat(a[i]));
            const Vec3f direction = aroundNormal(point.place.normal, cosine, toUnitFloat(b[i]));
            const EnvironmentSample s = context_.environment.lookUp(direction);
            w.samples.add(direction, s.radiance * (cosine / density(s.density, cosine, samples)));
        }
        w.samples.endGroup();
    }

private:
    const float environmentShare_, cosineShare_;

    /// Of `samples` samples together.
    float density(float environmentDensity, float cosine, float samples) const {
        return samples * (environmentShare_ * environmentDensity +
                          cosineShare_ * cosine / static_cast<float>(kPi));
    }
};

class Cosine final : public Mixture {
public:
    explicit Cosine(const EstimatorContext& context) : Mixture(context, 0, 1) {}

private:
    Rgb prepare(const ShadingPoint& point, const SampleSlice& slice, Workspace& w) const override {
        addCosineSamples(point, slice, static_cast<float>(slice.count), w);
        return {0, 0, 0};
    }
};

class MapOnly final : public Mixture {
public:
    explicit MapOnly(const EstimatorContext& context) : Mixture(context, 1, 0) {}

private:
    Rgb prepare(const ShadingPoint& point, const SampleSlice& slice, Workspace& w) const override {
        if (context_.environment.luminanceIntegral() > 0)
            addEnvironmentSamples(point, slice, static_cast<float>(slice.count), w);
        return {0, 0, 0};
    }
};

/// The samples of a pixel take turns between the two strategies; chance decides which comes first,
/// so that every one of them, whatever its number, is as likely of the one as of the other.
class Mis final : public Mixture {
public:
    explicit Mis(const EstimatorContext& context) : Mixture(context, 0.5f, 0.5f) {}

private:
    Rgb prepare(const ShadingPoint& point, const SampleSlice& slice, Workspace& w) const override {
        if (context_.environment.luminanceIntegral() <= 0) return {0, 0, 0};
        const auto turn =
            static_cast<std::uint32_t>(hashWords(point.slot.seed, RenderSalt::misTurn) >> 63);
        const auto samples = static_cast<float>(slice.count);
        addEnvironmentSamples(point, everySecond(slice, turn), samples, w);
        addCosineSamples(point, everySecond(slice, 1 - turn), samples, w);
        return {0, 0, 0};
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
