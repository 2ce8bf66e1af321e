#pragma once

#include <span>
#include <vector>

#include "render/cached/cache_plan.h"
#include "render/cached/light_batch.h"
#include "render/cached/place_lookup.h"
#include "render/regions/cosine_integrand.h"

namespace shadowcache {

/// The irradiance of a batch's points, step by step of lightBatch().
class CosineLight {
public:
    using Integrand = CosineIntegrand;

    /// All are used until the batch is lit.
    CosineLight(const EstimatorContext& context, const CachePlan& plan, const PointBatch& batch,
                const CellSplitter& splitter, PlaceLookup& lookup,
                LightTools<CosineIntegrand>& tools, Workspace& watch)
        : context_(context),
          frame_(plan),
          batch_(batch),
          splitter_(splitter),
          lookup_(lookup),
          tools_(tools),
          watch_(watch) {}

    CosineIntegrand::Points points() const { return {batch_.points}; }
    /// For each point, irradiance from which on one of its samples is heavy [luminance].
    std::span<const double> heavyFrom() const { return heavyFrom_; }

    const FittedRegions<CosineIntegrand>& regionsOf(const PointCluster& cluster,
                                                    std::span<const std::uint32_t> members);
    /// Numbers of samples of the points go to tools.counts.
    const SamplingPlan& plan(const Regions& regions, std::span<const std::uint32_t> members);
    void addIntegrals(const FittedRegions<CosineIntegrand>& fitted, const SamplingPlan& plan,
                      std::span<const std::uint32_t> members, std::span<Estimate> estimates) const;
    void trace(const PlannedCluster<CosineIntegrand>& cluster,
               std::span<const ClusterSample> samples, SampleTracer::Run& run) const;

private:
    const EstimatorContext& context_;
    const CachePlan& frame_;
    const PointBatch& batch_;
    const CellSplitter& splitter_;
    PlaceLookup& lookup_;
    LightTools<CosineIntegrand>& tools_;
    Workspace& watch_;
    std::vector<double> heavyFrom_;
};

}  // namespace shadowcache
