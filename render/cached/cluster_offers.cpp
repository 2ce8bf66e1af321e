#include "render/cached/cluster_offers.h"

#include <algorithm>

#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// What the points of a pixel receive of a misprediction is too heavy for their group alone from
/// this many times the heaviness from which on samples are reused.
SHADOWCACHE_TUNED(double, kWideReuse, 3);

/// Clusters that are asked how likely a misprediction is.
constexpr std::size_t kAskedClusters = 32;

}  // namespace

void ClusterOffers::begin(std::size_t points) {
    count_ = 0;
    points_.assign(points, {});
}

void ClusterOffers::add(std::span<const std::uint32_t> members, const Regions& regions,
                        const RegionShares& shares, const RegionDistribution& distribution,
                        const ClusterCounts& counts) {
    if (clusters_.size() == count_) clusters_.emplace_back(environment_);
    Cluster& cluster = clusters_[count_];
    cluster.distribution = distribution;
    cluster.groups.resize(shares.groups.size());
    for (std::size_t g = 0; g < shares.groups.size(); ++g) {
        const float* reuse = shares.groups[g].reuse;
        const float* visible = regions.groups[g].calibrated;
        for (int i = 0; i < kBlockCells; ++i) {
            cluster.groups[g].reuse[i] = reuse[i];
            cluster.groups[g].chance[i] = reuse[i] > 0 ? visible[i] : 1 - visible[i];
        }
    }
    cluster.samples = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
        Point& point = points_[members[i]];
        point.cluster = static_cast<std::uint32_t>(count_);
        point.samples = counts.ofRegions[i].expected;
        if (!counts.ofLobes.empty()) point.ofLobes = counts.ofLobes[i].expected;
        if (!counts.heavyFrom.empty()) point.tooHeavyFrom = kWideReuse * counts.heavyFrom[i];
        cluster.samples += point.samples;
    }
    ++count_;
}

ClusterOffers::Offer ClusterOffers::offerOf(std::size_t number, const Misprediction& found) const {
    const Cluster& cluster = clusters_[number];
    const RegionPlace place = cluster.distribution.find(found.cell);
    if (!place.found()) return {};
    const Group& group = cluster.groups[place.group];
    if (group.reuse[place.lane] == 0) return {};
    return {group.reuse[place.lane] > 0, group.chance[place.lane],
            cluster.distribution.chance(place),
            cluster.distribution.pdf(place, found.lightDensity)};
}

double ClusterOffers::chanceOf(const Misprediction& found) const {
    double weight = 0, chance = 0;  // where no cluster that is asked offers it: as if certain
    const std::size_t step = std::max<std::size_t>(1, count_ / kAskedClusters);
    for (std::size_t c = step / 2; c < count_; c += step) {
        const Offer offer = offerOf(c, found);
        const double samples = offer.samples * clusters_[c].samples;
        weight += samples;
        chance += samples * static_cast<double>(offer.chance);
    }
    return weight > 0 ? chance / weight : 1.0;
}

}  // namespace shadowcache
