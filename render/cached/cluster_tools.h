#pragma once

#include <span>
#include <vector>

#include "render/cached/cluster_sampler.h"
#include "render/cached/neighbor_reuse.h"
#include "render/cached/point_clusters.h"
#include "render/cached/sample_tracer.h"

namespace shadowcache {

/// What lighting a batch cluster by cluster takes; its memory is reused from batch to batch. One
/// object a thread.
struct ClusterTools {
    explicit ClusterTools(const Environment& environment)
        : distribution(environment), sampler(environment), reuse(environment) {}

    PointClusters clusters;
    std::vector<double> wanted;     ///< samples of a cluster's points
    std::vector<double> heavyFrom;  ///< irradiance from which on a sample is heavy [luminance]
    std::vector<PointShare> shares;
    RegionDistribution distribution;  ///< of a cluster
    ClusterSampler sampler;
    NeighborReuse reuse;
    SampleTracer tracer;

    /// Numbers of a cluster's points in the batch.
    std::span<const std::uint32_t> membersOf(const PointCluster& cluster) const {
        return clusters.order().subspan(cluster.begin, cluster.end - cluster.begin);
    }
};

}  // namespace shadowcache
