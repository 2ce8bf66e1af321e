#pragma once

#include <span>
#include <vector>

#include "render/cached/cluster_sampler.h"
#include "render/cached/neighbor_reuse.h"

namespace shadowcache {

/// Traces the samples of a cluster.
class ClusterLighting {
public:
    /// Adds to the points' estimates what their samples find beyond the control variate; hands
    /// mispredictions to `reuse`.
    void trace(const EstimatorContext& context, const PointBatch& batch, const Regions& regions,
               const SamplingPlan& plan, std::span<const ClusterSample> samples,
               NeighborReuse::Batch& reuse, std::span<Estimate> estimates);

private:
    /// What a ray that is still to be traced brings.
    struct Pending {
        std::uint32_t point;
        Rgb ifVisible, ifOccluded;
        float reuse;  ///< as PlannedGroup::reuse
        Misprediction found;
    };
    /// Luminance of a point's last sample that has no partner yet.
    struct Partner {
        float luminance = 0;
        bool waits = false;
        bool paired = false;  ///< it had one before
    };

    void flush(const EstimatorContext& context, NeighborReuse::Batch& reuse,
               std::span<Estimate> estimates);
    void addValue(const Environment& environment, std::uint32_t point, const Rgb& value,
                  std::span<Estimate> estimates);

    RayPacket packet_{};
    Pending pending_[RayPacket::kSize];
    int queued_ = 0;
    std::vector<Partner> partners_;  ///< by point
};

}  // namespace shadowcache
