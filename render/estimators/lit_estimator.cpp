#include "render/estimators/lit_estimator.h"

#include <algorithm>
#include <utility>

#include "common/base/stopwatch.h"
#include "render/estimators/group_split.h"

namespace shadowcache {

namespace {

/// Square of the share of the mean brightness below which errors are absolute, as relMSE has it.
constexpr double kFloor = 0.01;

struct LitWorkspace final : Workspace {
    LitWorkspace(std::unique_ptr<Workspace> ofSky, const EmitterLight& emitters)
        : sky(std::move(ofSky)), tools(emitters) {}

    /// Has the sky's estimator work with its own workspace, and passes on what it notes there.
    template <class Call>
    auto lend(const Call& call) {
        struct Return {
            LitWorkspace& to;
            ~Return() {
                Workspace& from = *to.sky;
                to.watched = std::move(from.watched);
                from.watched.clear();
                to.setupNanoseconds += std::exchange(from.setupNanoseconds, 0);
                to.traceNanoseconds += std::exchange(from.traceNanoseconds, 0);
                to.pointsWithoutItems += std::exchange(from.pointsWithoutItems, 0);
            }
        };
        sky->watchedPixel = watchedPixel;
        sky->watched = std::move(watched);
        const Return back{*this};
        return call(*sky);
    }

    std::unique_ptr<Workspace> sky;
    EmitterLight::Tools tools;
};

LitWorkspace& own(Workspace& workspace) {
    return static_cast<LitWorkspace&>(workspace);
}

EstimatorContext litContext(EstimatorContext context, const EmitterLight& emitters) {
    context.emitters = &emitters;
    return context;
}

class LitEstimator final : public Estimator,
                           private FramePilot,
                           private LightPrediction,
                           private InsightSource {
public:
    LitEstimator(std::unique_ptr<Estimator> sky, const EmitterLight& emitters)
        : Estimator(litContext(sky->context(), emitters)),
          sky_(std::move(sky)),
          emitters_(emitters),
          dark_(!(context_.environment.luminanceIntegral() > 0)) {}

    std::unique_ptr<Workspace> makeWorkspace() const override {
        return std::make_unique<LitWorkspace>(sky_->makeWorkspace(), emitters_);
    }

    using Estimator::estimate;
    void estimate(const PointBatch& batch, Workspace& workspace,
                  std::span<Estimate> estimates) const override {
        LitWorkspace& w = own(workspace);
        if (dark_)
            std::ranges::fill(estimates, Estimate{});
        else
            w.lend([&](Workspace& sky) { sky_->estimate(batch, sky, estimates); });
        Stopwatch time;
        const GroupSink sink = sinkOf<Estimate>(estimates, &Estimate::irradiance, w);
        for (std::size_t i = 0; i < batch.points.size(); ++i) {
            if (batch.samples > 0 && !batch.predict) break;
            const Rgb predicted = emitters_.predict(batch.points[i].place, w.tools,
                                                    batch.samples == 0 ? sink : GroupSink{}, i);
            (batch.samples == 0 ? estimates[i].irradiance : estimates[i].predicted) += predicted;
        }
        if (batch.samples > 0)
            emitters_.addIrradiance(batch, context_.environment.luminanceWeights(), w.tools,
                                    estimates, sink);
        w.traceNanoseconds += time.sinceLast();
    }

    void estimateGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                       Workspace& workspace, std::span<GlossEstimate> estimates) const override {
        LitWorkspace& w = own(workspace);
        if (dark_)
            std::ranges::fill(estimates, GlossEstimate{});
        else
            w.lend([&](Workspace& sky) { sky_->estimateGloss(batch, points, sky, estimates); });
        Stopwatch time;
        const GroupSink sink = sinkOf<GlossEstimate>(estimates, &GlossEstimate::radiance, w);
        if (batch.samples > 0)
            emitters_.addGloss(batch, points, context_.environment.luminanceWeights(), w.tools,
                               estimates, sink);
        for (std::size_t i = 0; batch.samples == 0 && i < points.size(); ++i)
            estimates[i].radiance += emitters_.predictGloss(points[i], w.tools, sink, i);
        w.traceNanoseconds += time.sinceLast();
    }

    /// The sky's, which knows what noise its light has; under a dark sky by that of emitters.
    const FramePilot* pilot() const override {
        const FramePilot* ofSky = sky_->pilot();
        if (!dark_ || !ofSky) return ofSky;
        return prediction() && ofSky->isAdaptive() ? this : nullptr;
    }
    const LightPrediction* prediction() const override {
        return sky_->prediction() ? this : nullptr;
    }
    const InsightSource* insights() const override { return sky_->insights() ? this : nullptr; }

private:
    /// Has the workspace hold the light of the sky, and what emitters add to it, by group.
    template <class T>
    GroupSink sinkOf(std::span<const T> ofSky, Rgb T::*light, Workspace& w) const {
        if (!context_.groups) return {};
        w.groups = ofSkyAlone(*context_.groups, ofSky, light);
        return {context_.groups, &w.groups};
    }

    Rgb predict(const SetPlace& place, Workspace& workspace) const override {
        LitWorkspace& w = own(workspace);
        return emitters_.predict(place, w.tools) +
               w.lend([&](Workspace& sky) { return sky_->prediction()->predict(place, sky); });
    }

    /// Of emitters alone: by what some samples of each place tell of their own noise.
    std::unique_ptr<const EstimatorPlan> plan(std::span<const ShadingPoint> points, int samples,
                                              double) const override {
        auto plan = std::make_unique<EstimatorPlan>();
        const std::unique_ptr<Workspace> workspace = makeWorkspace();
        // One sample tells nothing of its noise.
        const int each = std::max(samples, 2);
        std::vector<Estimate> estimates(points.size());
        estimate(points, each, *workspace, estimates);
        double brightness = 0, error = 0;
        const auto count = static_cast<double>(std::max<std::size_t>(points.size(), 1));
        const auto luminance = [&](const Estimate& e) {
            return static_cast<double>(context_.environment.luminance(e.irradiance));
        };
        for (const Estimate& e : estimates) brightness += luminance(e) / count;
        for (const Estimate& e : estimates) {
            plan->rays += e.rays;
            const double scale = luminance(e) * luminance(e) + kFloor * brightness * brightness;
            if (scale > 0) error += static_cast<double>(e.variance) / scale / count;
        }
        plan->predictedError = error * each / samples;
        return plan;
    }

    CacheInsight insight(const ShadingPoint& point, int samples, const EstimatorPlan* plan,
                         Workspace& workspace) const override {
        return own(workspace).lend([&](Workspace& sky) {
            return sky_->insights()->insight(point, samples, dark_ ? nullptr : plan, sky);
        });
    }

    const std::unique_ptr<Estimator> sky_;
    const EmitterLight& emitters_;
    const bool dark_;  ///< the sky sends no light
};

}  // namespace

std::unique_ptr<Estimator> withEmitters(std::unique_ptr<Estimator> sky,
                                        const EmitterLight& emitters) {
    return std::make_unique<LitEstimator>(std::move(sky), emitters);
}

}  // namespace shadowcache
