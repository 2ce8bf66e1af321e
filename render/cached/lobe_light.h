#pragma once

#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "common/random/salts.h"
#include "render/cached/cache_plan.h"
#include "render/cached/light_batch.h"
#include "render/cached/place_lookup.h"
#include "render/regions/lobe_integrand.h"
#include "render/regions/lobe_match.h"

namespace shadowcache {

/// How samples of glossy points are planned.
PlanRules lobeRules();

/// What glossy points need of a map, whatever their place.
struct LobeTables {
    LobeTables(const Environment& environment, const DirectionTiers& tiers)
        : cells(environment, tiers) {}

    QuadraticCells cells;
};

/// Tables that are made when they are asked for first. Thread-safe.
class LazyLobeTables {
public:
    const LobeTables& of(const EstimatorContext& context) const;

private:
    mutable std::once_flag made_;
    mutable std::optional<LobeTables> tables_;
};

/// Scratch memory of LobeLight, one a thread.
struct LobeWorkspace {
    LobeWorkspace(const Environment& environment, const DirectionTiers& tiers)
        : tools(environment, tiers, lobeRules()) {}

    LightTools<LobeIntegrand> tools;
    std::vector<ShadingPoint> points;
    std::vector<Estimate> estimates;
    std::vector<LobeMatch::Fit> matches;  ///< by member
    std::vector<SampleCount> lobeCounts;  ///< of samples of the lobes, by member
    std::vector<double> lobeSamples;      ///< expected of these, by point
    std::vector<std::uint32_t> memberOf;  ///< by point
    std::vector<std::uint32_t> u, v;
};

/// What a batch's glossy points reflect, step by step of lightBatch(): beside samples of the
/// regions, samples of the points' own lobes. The balance heuristic combines them.
class LobeLight {
public:
    using Integrand = LobeIntegrand;

    /// All are used until the batch is lit.
    ///
    /// @param points  whose places are the batch's
    /// @param leastNoise  of an irradiance, below which a cell stays whole [radiance sr]
    LobeLight(const EstimatorContext& context, const CachePlan& plan, const PointBatch& batch,
              std::span<const GlossyPoint> points, const LobeTables& tables, float leastNoise,
              PlaceLookup& lookup, LobeWorkspace& w);

    LobeIntegrand::Points points() const { return {points_, w_.lobeSamples}; }
    /// None: nothing is too heavy for a group.
    std::span<const double> heavyFrom() const { return {}; }

    const FittedRegions<LobeIntegrand>& regionsOf(const PointCluster& cluster,
                                                  std::span<const std::uint32_t> members);
    /// Numbers of samples of the points go to tools.counts.
    const SamplingPlan& plan(const Regions& regions, std::span<const std::uint32_t> members);
    void addIntegrals(const FittedRegions<LobeIntegrand>& fitted, const SamplingPlan& plan,
                      std::span<const std::uint32_t> members, std::span<Estimate> estimates) const;
    void trace(const PlannedCluster<LobeIntegrand>& cluster, std::span<const ClusterSample> samples,
               SampleTracer::Run& run);

    /// What the cache predicts of all points, without a ray.
    void predict(std::span<Estimate> estimates);

private:
    const FittedRegions<LobeIntegrand>& build(const GlossyLobe& lobe, float misfit);
    /// Pools the counts around a cluster and matches its lobes to the central one.
    ///
    /// @return the regions, whose fits are of use if `fitted`
    const FittedRegions<LobeIntegrand>& match(const PointCluster& cluster,
                                              std::span<const std::uint32_t> members, bool fitted);
    void roundSamples(std::span<const std::uint32_t> members, double part, RenderSalt salt,
                      std::vector<SampleCount>& counts);
    void traceLobes(const PlannedCluster<LobeIntegrand>& cluster, SampleTracer::Run& run);
    void traceOne(const PlannedCluster<LobeIntegrand>& cluster, std::uint32_t member,
                  const RegionPlace& place, const EnvironmentSample& s, double lightDensity,
                  SampleTracer::Run& run) const;

    const EstimatorContext& context_;
    const CachePlan& frame_;
    const PointBatch& batch_;
    std::span<const GlossyPoint> points_;
    const LobeTables& tables_;
    float leastNoise_;
    PlaceLookup& lookup_;
    LobeWorkspace& w_;
    double partOfLobes_ = 0;  ///< of the cluster's samples, drawn from the lobes
};

}  // namespace shadowcache
