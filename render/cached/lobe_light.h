#pragma once

#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "common/random/salts.h"
#include "render/cached/light_batch.h"
#include "render/regions/lobe_integrand.h"
#include "render/regions/lobe_match.h"

namespace shadowcache {

/// How samples of glossy points are planned.
ShareRules lobeRules();

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
    std::vector<LobeMatch::Fit> matches;  ///< by member of a cluster
    std::vector<SampleCount> lobeCounts;  ///< of samples of the lobes, by member
    std::vector<std::uint32_t> u, v;
};

/// What a batch's glossy points reflect, by the steps of lightBatch(): beside samples of the
/// regions, samples of the points' own lobes. The balance heuristic combines them.
class LobeLight {
public:
    using Integrand = LobeIntegrand;
    /// The light around a cluster, and what stands in for the lobes of its points.
    struct Model {
        const FittedRegions<LobeIntegrand>& fitted;  ///< for the central lobe
        std::span<const LobeMatch::Fit> matches;     ///< how far that stands for the others
        double partOfLobes = 0;                      ///< of the samples, drawn from the lobes
    };

    /// All are used until the batch is lit.
    ///
    /// @param points  whose places are the batch's
    /// @param leastNoise  of an irradiance, below which a cell stays whole [radiance sr]
    LobeLight(const CachedBatch& batch, std::span<const GlossyPoint> points,
              const LobeTables& tables, float leastNoise, LobeWorkspace& w)
        : batch_(batch), points_(points), tables_(tables), leastNoise_(leastNoise), w_(w) {}

    LobeIntegrand::Points points() const { return {points_}; }

    Model modelOf(const PointCluster& cluster);
    ClusterCounts countSamples(const PointCluster& cluster, const Model& model);
    const RegionShares& shareSamples(const Regions& regions, const ClusterCounts& counts);
    /// Sets what is reflected to the integral of what stands in for the integrand.
    void integrate(const SampledCluster<LobeLight>& cluster, std::span<Estimate> estimates) const;
    /// Traces samples of the regions, and as many of the lobes as are counted.
    void trace(const SampledCluster<LobeLight>& cluster, std::span<const ClusterSample> samples,
               SampleTracer::Run& run);

    /// What the cache predicts of all points, without a ray.
    void predict(std::span<Estimate> estimates);

private:
    const FittedRegions<LobeIntegrand>& build(const GlossyLobe& lobe, float misfit);
    /// Pools the counts around a cluster and matches its lobes to the central one.
    ///
    /// @param fitted  whether the fits are of use
    Model match(const PointCluster& cluster, bool fitted);
    std::span<const SampleCount> round(const PointCluster& cluster, double part, RenderSalt salt,
                                       std::vector<SampleCount>& counts);
    void traceLobes(const SampledCluster<LobeLight>& cluster, SampleTracer::Run& run);
    void traceOne(const SampledCluster<LobeLight>& cluster, std::uint32_t member,
                  const RegionPlace& region, const EnvironmentSample& s, double lightDensity,
                  SampleTracer::Run& run) const;

    const CachedBatch& batch_;
    std::span<const GlossyPoint> points_;
    const LobeTables& tables_;
    float leastNoise_;
    LobeWorkspace& w_;
};

}  // namespace shadowcache
