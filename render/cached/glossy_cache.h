#pragma once

#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "render/cached/cluster_tools.h"
#include "render/cached/glossy_lighting.h"
#include "render/cached/place_lookup.h"

namespace shadowcache {

/// How samples of glossy points are planned.
PlanRules glossyRules();

/// Scratch memory of GlossyCache, one a thread.
struct GlossyWorkspace {
    GlossyWorkspace(const Environment& environment, const DirectionTiers& tiers);

    RegionBuilder<LobeIntegrand> builder;
    float leastNoise;  ///< of a cell, where the irradiance is integrated [radiance sr]
    SamplingPlanner planner;
    std::vector<ShadingPoint> points;
    std::vector<Estimate> estimates;
    std::vector<LobeMatch::Fit> matches;
    std::vector<PointShare> lobeShares;
    GlossyLighting lighting;
};

/// What is known of a frame as a whole.
struct GlossyFrame {
    const Calibration& calibration;
    double darkest;  ///< radiance below which errors count no more [luminance]
};

/// What glossy points reflect, by a cache: quadratics as control variate, samples of regions and of
/// lobes, mispredictions reused by neighbours. Thread-safe. [docs/estimator.md]
class GlossyCache {
public:
    explicit GlossyCache(const EstimatorContext& context) : context_(context) {}

    /// Lights the points of a batch. Without samples: what the cache predicts.
    ///
    /// @param estimates  of the points, 0 before
    void estimate(const PointBatch& batch, std::span<const GlossyPoint> points,
                  const GlossyFrame& frame, PlaceLookup& lookup, ClusterTools& tools,
                  GlossyWorkspace& own, Workspace& watch, std::span<GlossEstimate> estimates) const;

private:
    struct Batch;

    const GlossyTables& tables() const;
    /// @param fitted  whether fits are of use
    const FittedRegions<LobeIntegrand>& regionsOf(const Batch& batch, const PointCluster& cluster,
                                                  bool fitted) const;
    const FittedRegions<LobeIntegrand>& build(const Batch& batch, const GlossyLobe& lobe,
                                              float misfit) const;
    GlossyCluster prepare(const Batch& batch, const PointCluster& cluster,
                          NeighborReuse::Batch& reuse) const;
    void predict(const Batch& batch, const PointCluster& cluster) const;

    const EstimatorContext& context_;
    mutable std::once_flag tablesMade_;
    mutable std::optional<GlossyTables> tables_;  ///< once a glossy point was met
};

}  // namespace shadowcache
