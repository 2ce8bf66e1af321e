#pragma once

#include <memory>
#include <span>

#include "common/cache/shadow_cache.h"
#include "common/light/environment.h"
#include "common/predict/bounce_solve.h"
#include "common/random/sequence.h"
#include "common/trace/scene.h"
#include "render/estimators/cache_insight.h"
#include "render/estimators/estimate.h"
#include "render/estimators/frame_pilot.h"
#include "render/estimators/light_prediction.h"
#include "render/estimators/shading_point.h"
#include "render/estimators/workspace.h"

namespace shadowcache {

class EmitterLight;
class GroupedSolve;
class LightGroups;
class RadiosityTree;

/// What every estimator works with; all outlive it.
struct EstimatorContext {
    const Scene& scene;
    const Environment& environment;
    const ShadowCache* cache;  ///< may be null
    Sequence sequence = Sequence::kSobol;
    /// What the cache predicts of the light that bounces under this environment; may be null.
    const BounceSolve* solve = nullptr;
    /// What shines in the set, which direct light includes; null: nothing does, or rays of paths
    /// meet it.
    const EmitterLight* emitters = nullptr;
    /// Whose light is kept apart; null: all of it is one.
    const LightGroups* groups = nullptr;
    /// What `solve` predicts, by group; null without groups, or without a solve.
    const GroupedSolve* groupedSolve = nullptr;
    /// Where the light that bounces comes from, by `solve`; null: paths are not guided.
    const RadiosityTree* radiosity = nullptr;
};

/// An estimator of irradiance. Immutable; thread-safe through one workspace a thread. Most derive
/// from PointEstimator.
class Estimator {
public:
    explicit Estimator(const EstimatorContext& context) : context_(context) {}
    virtual ~Estimator() = default;
    Estimator(const Estimator&) = delete;
    Estimator& operator=(const Estimator&) = delete;

    const EstimatorContext& context() const { return context_; }

    virtual std::unique_ptr<Workspace> makeWorkspace() const;

    /// Lights the points of a batch and keeps the time; estimates[i] is that of points[i]. Points
    /// may gain from what the others' rays find.
    virtual void estimate(const PointBatch& batch, Workspace& workspace,
                          std::span<Estimate> estimates) const = 0;
    /// The same of points that are the only ones of their pixels.
    void estimate(std::span<const ShadingPoint> points, int samples, Workspace& workspace,
                  std::span<Estimate> estimates, const EstimatorPlan* plan = nullptr) const;
    /// The same at one point.
    Estimate estimate(const ShadingPoint& point, int samples, Workspace& workspace,
                      const EstimatorPlan* plan = nullptr) const;

    /// What the lobes of glossy points reflect, with as many samples of each point as the batch
    /// wants for the irradiance: from the map and from the lobe, weighted by the balance heuristic.
    /// @param points  of a batch's, in its order
    virtual void estimateGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                               Workspace& workspace, std::span<GlossEstimate> estimates) const;

    /// Null where frames need no pilot.
    virtual const FramePilot* pilot() const { return nullptr; }
    /// Null where nothing is predicted.
    virtual const LightPrediction* prediction() const { return nullptr; }
    /// Null where no cache is read.
    virtual const InsightSource* insights() const { return nullptr; }

protected:
    const EstimatorContext context_;
};

/// An estimator that lights each point by itself.
class PointEstimator : public Estimator {
public:
    using Estimator::estimate;
    using Estimator::Estimator;

    void estimate(const PointBatch& batch, Workspace& workspace,
                  std::span<Estimate> estimates) const override;

protected:
    /// Fills workspace.samples with the directions to test, decided before any ray is traced.
    ///
    /// @return the part of the irradiance that needs no ray
    virtual Rgb prepare(const ShadingPoint& point, const SampleSlice& slice,
                        Workspace& workspace) const = 0;
};

}  // namespace shadowcache
