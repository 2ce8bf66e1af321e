#include "render/cached/neighbor_reuse.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/tuned.h"
#include "render/regions/cosine_integrand.h"
#include "render/regions/lobe_integrand.h"

namespace shadowcache {

namespace {

/// Most pixels of a group.
constexpr double kMostGroupPixels = 256;

/// What the points of a pixel receive of a misprediction is too heavy for their group alone from
/// this many times the heaviness from which on samples are reused.
SHADOWCACHE_TUNED(double, kWideReuse, 3);
/// Rows of a batch that reuse together what is too heavy for a group: about 4096 points of a tile,
/// more where pixels have more camera rays.
constexpr std::uint32_t kWideRows = 16;

/// Clusters that are asked how likely a misprediction is.
constexpr std::size_t kAskedClusters = 32;

}  // namespace

double pixelsOfGroup(double chance, double perFind) {
    return std::clamp(perFind / std::max(chance, 1e-12), 1.0, kMostGroupPixels);
}

template <Integrand I>
NeighborReuse<I>::NeighborReuse(const Environment& environment) : environment_(environment) {
    sizes_.resize(cellCount(Environment::kLevel));
    sizeBatch_.resize(cellCount(Environment::kLevel));
}

template <Integrand I>
typename NeighborReuse<I>::Batch NeighborReuse<I>::begin(const PointBatch& batch,
                                                         const PointClusters& clusters,
                                                         const typename I::Points& points) {
    batch_ = batch;
    points_ = points;
    clusters_ = &clusters;
    count_ = 0;
    found_.clear();
    ++batchNumber_;
    const std::size_t count = batch.points.size();
    samples_.assign(count, 0);
    tooHeavyFrom_.assign(count, std::numeric_limits<double>::infinity());
    pixelReceived_.resize(batch.pixels);
    clusterOf_.resize(count);
    for (std::uint32_t c = 0; c < clusters.clusters().size(); ++c) {
        const PointCluster& cluster = clusters.clusters()[c];
        for (std::uint32_t i = cluster.begin; i < cluster.end; ++i)
            clusterOf_[clusters.order()[i]] = c;
    }
    rows_ = 0;
    for (const ShadingPoint& point : batch.points) rows_ = std::max(rows_, point.row + 1);
    pointAt_.assign(std::size_t{rows_} * batch.pixels, -1);
    for (std::size_t i = 0; i < count; ++i) {
        const ShadingPoint& point = batch.points[i];
        std::int32_t& first = pointAt_[std::size_t{point.row} * batch.pixels + point.pixel];
        if (first < 0)
            first = static_cast<std::int32_t>(i);
        else
            assert(batch.points[i - 1].pixel == point.pixel &&
                   batch.points[i - 1].row == point.row);
    }
    return Batch(*this);
}

template <Integrand I>
void NeighborReuse<I>::Batch::addCluster(const Regions& regions, const SamplingPlan& plan,
                                         const RegionDistribution& distribution,
                                         std::span<const std::uint32_t> members,
                                         std::span<const SampleCount> counts,
                                         std::span<const double> heavyFrom) {
    NeighborReuse<I>& r = reuse_;
    if (r.offers_.size() == r.count_) r.offers_.emplace_back(r.environment_);
    ClusterOffers& cluster = r.offers_[r.count_++];
    cluster.distribution = distribution;
    cluster.offers.resize(plan.groups.size());
    for (std::size_t g = 0; g < plan.groups.size(); ++g) {
        const float* reuse = plan.groups[g].reuse;
        const float* visible = regions.groups[g].calibrated;
        for (int i = 0; i < kBlockCells; ++i) {
            cluster.offers[g].reuse[i] = reuse[i];
            cluster.offers[g].chance[i] = reuse[i] > 0 ? visible[i] : 1 - visible[i];
        }
    }
    cluster.samples = 0;
    for (std::size_t i = 0; i < members.size(); ++i) {
        r.samples_[members[i]] = counts[i].expected;
        cluster.samples += counts[i].expected;
    }
    for (std::size_t i = 0; i < heavyFrom.size(); ++i)
        r.tooHeavyFrom_[members[i]] = kWideReuse * heavyFrom[i];
}

template <Integrand I>
void NeighborReuse<I>::Batch::finish(const Scene& scene, std::span<Estimate> estimates) {
    NeighborReuse<I>& r = reuse_;
    r.offered_.resize(r.count_);
    r.offeredNumber_.resize(std::max(r.offeredNumber_.size(), r.count_), 0);
    for (const Misprediction& found : r.found_) {
        ++r.foundNumber_;
        r.findMispredicted(found, scene, estimates);
        r.contribute(found, estimates);
    }
}

template <Integrand I>
typename NeighborReuse<I>::Offered NeighborReuse<I>::offered(const ClusterOffers& cluster,
                                                             const Misprediction& found) {
    const RegionPlace place = cluster.distribution.find(found.cell);
    if (!place.found()) return {};
    const Offer& offer = cluster.offers[place.group];
    if (offer.reuse[place.lane] == 0) return {};
    return {offer.reuse[place.lane] > 0, offer.chance[place.lane],
            cluster.distribution.chance(place),
            cluster.distribution.pdf(place, found.lightDensity)};
}

/// Pixels of a group, a power of two: by the chance of a misprediction in the direction's cell,
/// over the batch, so that all points that may find one there agree about their groups.
template <Integrand I>
std::uint32_t NeighborReuse<I>::groupSize(const Misprediction& found) {
    if (sizeBatch_[found.cell] == batchNumber_) return sizes_[found.cell];
    double weight = 0, chance = 0;  // where no cluster that is asked offers it: as if certain
    const std::size_t step = std::max<std::size_t>(1, count_ / kAskedClusters);
    for (std::size_t c = step / 2; c < count_; c += step) {
        const Offered offer = offered(offers_[c], found);
        const double samples = offer.samples * offers_[c].samples;
        weight += samples;
        chance += samples * static_cast<double>(offer.chance);
    }
    const double most =
        pixelsOfGroup(weight > 0 ? chance / weight : 1.0, I::Points::groupPerFind());
    sizeBatch_[found.cell] = batchNumber_;
    return sizes_[found.cell] = std::max(1u, std::bit_floor(static_cast<std::uint32_t>(most)));
}

/// The points that reuse a direction: the mispredicted ones of the finder's group, or, where what
/// they receive is too heavy, those of all such groups of its rows. Whether it is depends on the
/// direction and on the group, not on who found it, so both divide the points into disjoint sets.
template <Integrand I>
void NeighborReuse<I>::findMispredicted(const Misprediction& found, const Scene& scene,
                                        std::span<Estimate> estimates) {
    const ShadingPoint& finder = batch_.points[found.finder];
    const std::uint32_t size = groupSize(found);
    const std::uint32_t first = finder.pixel / size * size;
    const std::uint32_t end = std::min(first + size, batch_.pixels);
    candidates_.clear();
    addCandidates(found, finder.row, first, end);
    keepMispredicted(found, scene, estimates);
    if (rows_ < 2 || !isTooHeavy(found, candidates_)) return;

    const std::uint32_t firstRow = finder.row / kWideRows * kWideRows;
    const std::uint32_t lastRow = std::min(firstRow + kWideRows, rows_);
    ownGroup_.swap(candidates_);
    candidates_.clear();
    for (std::uint32_t row = firstRow; row < lastRow; ++row) {
        if (row != finder.row) {
            addCandidates(found, row, 0, batch_.pixels);
            continue;
        }
        addCandidates(found, row, 0, first);
        candidates_.insert(candidates_.end(), ownGroup_.begin(), ownGroup_.end());
        addCandidates(found, row, end, batch_.pixels);
    }
    keepMispredicted(found, scene, estimates);
    keepTooHeavyGroups(found, size);
}

template <Integrand I>
double NeighborReuse<I>::sumOfDensities(std::span<const Candidate> candidates) {
    double density = 0;
    for (const Candidate& c : candidates) density += c.density;
    return density;
}

template <Integrand I>
bool NeighborReuse<I>::isTooHeavy(const Misprediction& found,
                                  std::span<const Candidate> group) const {
    const double density = sumOfDensities(group);
    double ofPixel = 0;  // what its points receive, over what is too much
    for (std::size_t i = 0; i < group.size(); ++i) {
        const std::uint32_t point = group[i].point;
        if (i > 0 && batch_.points[point].pixel != batch_.points[group[i - 1].point].pixel)
            ofPixel = 0;
        const Rgb value = received(point, found, density);
        ofPixel += static_cast<double>(environment_.luminance(value)) / tooHeavyFrom_[point];
        if (ofPixel > 1) return true;
    }
    return false;
}

template <Integrand I>
void NeighborReuse<I>::keepTooHeavyGroups(const Misprediction& found, std::uint32_t size) {
    const auto groupOf = [&](const Candidate& c) {
        const ShadingPoint& point = batch_.points[c.point];
        return std::pair(point.row, point.pixel / size);
    };
    auto kept = candidates_.begin();
    for (auto begin = kept; begin != candidates_.end();) {
        const auto end = std::find_if(begin, candidates_.end(), [&](const Candidate& c) {
            return groupOf(c) != groupOf(*begin);
        });
        const bool keeps = isTooHeavy(found, {begin, end});
        for (; begin != end; ++begin)
            if (keeps) *kept++ = *begin;
    }
    candidates_.erase(kept, candidates_.end());
}

template <Integrand I>
void NeighborReuse<I>::addCandidates(const Misprediction& found, std::uint32_t row,
                                     std::uint32_t first, std::uint32_t last) {
    const std::int32_t* firstPoints = pointAt_.data() + std::size_t{row} * batch_.pixels;
    for (std::uint32_t pixel = first; pixel < last; ++pixel) {
        if (firstPoints[pixel] < 0) continue;
        for (auto point = static_cast<std::uint32_t>(firstPoints[pixel]);
             point < batch_.points.size() && batch_.points[point].pixel == pixel &&
             batch_.points[point].row == row;
             ++point)
            addCandidate(found, point);
    }
}

template <Integrand I>
void NeighborReuse<I>::addCandidate(const Misprediction& found, std::uint32_t point) {
    if (!(samples_[point] > 0)) return;
    if (found.direction.dot(points_.normal(point)) <= 0) return;
    const std::uint32_t c = clusterOf_[point];
    if (offeredNumber_[c] != foundNumber_) {
        offeredNumber_[c] = foundNumber_;
        offered_[c] = offered(offers_[c], found);
    }
    const Offered& offer = offered_[c];
    if (offer.samples == 0) return;
    const double density =
        offer.density * samples_[point] + points_.otherDensity(point, found.direction);
    candidates_.push_back({point, density, offer.visible, point == found.finder});
}

/// Removes the candidates that the direction does not contradict, by a ray for each that is not
/// known; the others keep their order.
template <Integrand I>
void NeighborReuse<I>::keepMispredicted(const Misprediction& found, const Scene& scene,
                                        std::span<Estimate> estimates) {
    std::size_t kept = 0;
    RayPacket packet{};
    std::array<Candidate, RayPacket::kSize> queue;
    int queued = 0;
    const auto flush = [&] {
        const std::uint32_t visible = scene.visibility(packet, queued);
        for (int i = 0; i < queued; ++i) {
            const Candidate& c = queue[static_cast<std::size_t>(i)];
            ++estimates[c.point].reused;
            if ((visible >> i & 1u) != (c.visible ? 1u : 0u)) continue;
            candidates_[kept] = c;
            candidates_[kept++].isKnown = true;
        }
        queued = 0;
    };
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        const Candidate c = candidates_[i];
        if (c.isKnown) {
            if (queued > 0) flush();
            candidates_[kept++] = c;
            continue;
        }
        packet.set(queued, batch_.points[c.point].rayOrigin, found.direction);
        queue[static_cast<std::size_t>(queued++)] = c;
        if (queued == RayPacket::kSize) flush();
    }
    if (queued > 0) flush();
    candidates_.resize(kept);
}

/// Estimates of a pixel that receive the same misprediction err alike.
template <Integrand I>
void NeighborReuse<I>::contribute(const Misprediction& found, std::span<Estimate> estimates) {
    const double density = sumOfDensities(candidates_);
    for (const Candidate& c : candidates_) pixelReceived_[batch_.points[c.point].pixel] = 0;
    for (const Candidate& c : candidates_) {
        const Rgb added = received(c.point, found, c.visible ? density : -density);
        estimates[c.point].irradiance += added;
        pixelReceived_[batch_.points[c.point].pixel] += environment_.luminance(added);
    }
    for (const Candidate& c : candidates_) {
        const float own =
            environment_.luminance(received(c.point, found, c.visible ? density : -density));
        Estimate& estimate = estimates[c.point];
        estimate.variance += own * own;
        estimate.covariance += own * (pixelReceived_[batch_.points[c.point].pixel] - own);
    }
}

template class NeighborReuse<CosineIntegrand>;
template class NeighborReuse<LobeIntegrand>;

}  // namespace shadowcache
