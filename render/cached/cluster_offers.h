#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "render/cached/cluster_sampler.h"
#include "render/cached/sample_tracer.h"
#include "render/regions/region_distribution.h"

namespace shadowcache {

/// Where the clusters of a batch have samples whose mispredictions are reused, and with which
/// density. Decided by the plans alone, before any ray.
class ClusterOffers {
public:
    explicit ClusterOffers(const Environment& environment) : environment_(environment) {}

    /// Begins a batch of so many points, without clusters. Memory is used again.
    void begin(std::size_t points);
    /// Adds the next cluster.
    void add(std::span<const std::uint32_t> members, const Regions& regions,
             const RegionShares& shares, const RegionDistribution& distribution,
             const ClusterCounts& counts);

    /// What is known of a point.
    struct Point {
        std::uint32_t cluster = 0;
        double samples = 0;    ///< of the regions: their number on average
        double ofLobes = 0;    ///< and of its lobe
        double tooHeavyFrom =  ///< what its pixel receives is too heavy for a group from here on
            std::numeric_limits<double>::infinity();  ///< [luminance]
    };
    const Point& point(std::uint32_t number) const { return points_[number]; }

    /// What a cluster offers in the region that holds a direction.
    struct Offer {
        bool visible = false;  ///< what is mispredicted there
        float chance = 0;      ///< of a misprediction
        double samples = 0;    ///< there, for each of a point; 0: nothing is offered
        double density = 0;    ///< of one sample of a point, along the direction
    };
    Offer offerOf(std::size_t cluster, const Misprediction& found) const;

    std::size_t count() const { return count_; }
    /// Chance of a misprediction in a direction, over all samples of the batch there.
    double chanceOf(const Misprediction& found) const;

private:
    /// Of sixteen regions: GroupShares::reuse, and the probability of a misprediction.
    struct Group {
        float reuse[kBlockCells];
        float chance[kBlockCells];
    };
    struct Cluster {
        explicit Cluster(const Environment& environment) : distribution(environment) {}

        RegionDistribution distribution;
        std::vector<Group> groups;  ///< as Regions::groups
        double samples = 0;         ///< of all its points
    };

    const Environment& environment_;
    std::vector<Cluster> clusters_;  ///< only the first count_ are of this batch
    std::size_t count_ = 0;
    std::vector<Point> points_;
};

}  // namespace shadowcache
