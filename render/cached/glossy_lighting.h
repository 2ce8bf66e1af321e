#pragma once

#include <span>
#include <vector>

#include "render/cached/cluster_sampler.h"
#include "render/cached/lobe_integrand.h"
#include "render/cached/lobe_match.h"
#include "render/cached/sample_tracer.h"

namespace shadowcache {

/// What glossy points need of a map, whatever their place.
struct GlossyTables {
    GlossyTables(const Environment& environment, const DirectionTiers& tiers)
        : texels(environment), cells(environment, tiers) {}

    TexelCells texels;
    QuadraticCells cells;
};

/// All that is decided of a cluster of glossy points before any ray.
struct GlossyCluster {
    std::span<const std::uint32_t> members;
    std::span<const PointShare> ofRegions, ofLobes;  ///< samples of the members
    const FittedRegions<LobeIntegrand>& fitted;
    const SamplingPlan& plan;
    const RegionDistribution& distribution;   ///< of the plan
    std::span<const LobeMatch::Fit> matches;  ///< of the members
};

/// Share of a cluster's samples that are drawn from the lobes: less where regions resolve them.
double lobeShare(const GlossyLobe& lobe);

/// Lights the glossy points of a cluster: samples of the regions and of the points' lobes, weighted
/// by the balance heuristic, against the quadratics. [docs/estimator.md]
class GlossyLighting {
public:
    /// @param samples  of the regions
    void trace(const EstimatorContext& context, const GlossyTables& tables, const PointBatch& batch,
               std::span<const GlossyPoint> points, const GlossyCluster& cluster,
               std::span<const ClusterSample> samples, SampleTracer::Run& run);

private:
    struct Task;
    /// A sample, drawn from wherever.
    struct Sample {
        std::uint32_t member;
        RegionPlace place;
        EnvironmentSample light;
        double lightDensity;  ///< density of samples in proportion to the light [radiance]
    };
    void traceRegions(const Task& task, std::span<const ClusterSample> samples);
    void traceLobes(const Task& task);
    void add(const Task& task, const Sample& sample) const;

    std::vector<std::uint32_t> memberOf_;  ///< by point
    std::vector<std::uint32_t> u_, v_;
};

}  // namespace shadowcache
