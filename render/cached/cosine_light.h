#pragma once

#include <span>
#include <vector>

#include "render/cached/light_batch.h"
#include "render/regions/cosine_integrand.h"

namespace shadowcache {

/// The irradiance of a batch's points: the steps of lightBatch().
class CosineLight {
public:
    using Integrand = CosineIntegrand;
    /// The light around a cluster, and what stands in for the cosine of its points.
    struct Model {
        const FittedRegions<CosineIntegrand>& fitted;
    };

    /// All are used until the batch is lit.
    CosineLight(const CachedBatch& batch, const CellSplitter& splitter,
                LightTools<CosineIntegrand>& tools)
        : batch_(batch), splitter_(splitter), tools_(tools) {}

    CosineIntegrand::Points points() const { return {batch_.points.points}; }

    Model modelOf(const PointCluster& cluster);
    /// Shares samples out by the noise that is predicted of each point.
    ClusterCounts countSamples(const PointCluster& cluster, const Model& model);
    const RegionShares& shareSamples(const Regions& regions, const ClusterCounts& counts);
    /// Sets the irradiance to the integral of what stands in for the integrand.
    void integrate(const SampledCluster<CosineLight>& cluster, std::span<Estimate> estimates) const;
    void trace(const SampledCluster<CosineLight>& cluster, std::span<const ClusterSample> samples,
               SampleTracer::Run& run) const;

private:
    const CachedBatch& batch_;
    const CellSplitter& splitter_;
    LightTools<CosineIntegrand>& tools_;
    std::vector<double> heavyFrom_;
};

}  // namespace shadowcache
