#include "render/cached/neighbor_reuse.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "render/regions/cosine_integrand.h"
#include "render/regions/lobe_integrand.h"

namespace shadowcache {

namespace {

/// Most pixels of a group.
constexpr double kMostGroupPixels = 256;

/// Rows of a batch that reuse together what is too heavy for a group: about 4096 points of a tile,
/// more where pixels have more camera rays.
constexpr std::uint32_t kWideRows = 16;

template <class Candidates>
double sumOfDensities(const Candidates& candidates) {
    double density = 0;
    for (const auto& c : candidates) density += c.density;
    return density;
}

}  // namespace

double pixelsOfGroup(double chance, double perFind) {
    return std::clamp(perFind / std::max(chance, 1e-12), 1.0, kMostGroupPixels);
}

template <Integrand I>
void NeighborReuse<I>::share(std::span<const Misprediction> found, const ClusterOffers& offers,
                             const Receivers& receivers) {
    if (found.empty()) return;
    rows_.assign(receivers.batch);
    pixelReceived_.resize(receivers.batch.pixels);
    groupSizes_.forget(cellCount(Environment::kLevel));
    for (const Misprediction& one : found) {
        offered_.forget(offers.count());
        const Task task{one, offers, receivers};
        findMispredicted(task);
        contribute(task);
    }
}

/// A power of two: by the chance of a misprediction in the direction's cell, over the batch, so
/// that all points that may find one there agree about their groups.
template <Integrand I>
std::uint32_t NeighborReuse<I>::groupSize(const Task& task) {
    return groupSizes_.at(task.found.cell, [&] {
        const double most =
            pixelsOfGroup(task.offers.chanceOf(task.found), I::Points::groupPerFind());
        return std::max(1u, std::bit_floor(static_cast<std::uint32_t>(most)));
    });
}

/// The points that reuse a direction: the mispredicted ones of the finder's group, or, where what
/// they receive is too heavy, those of all such groups of its rows. Whether it is depends on the
/// direction and on the group, not on who found it, so both divide the points into disjoint sets.
template <Integrand I>
void NeighborReuse<I>::findMispredicted(const Task& task) {
    const BatchSlot& finder = task.receivers.batch.points[task.found.finder].slot;
    const std::uint32_t size = groupSize(task);
    const std::uint32_t first = finder.pixel / size * size;
    const std::uint32_t end = std::min(first + size, rows_.pixels());
    candidates_.clear();
    addCandidates(task, finder.row, first, end);
    keepMispredicted(task);
    if (rows_.rows() < 2 || !isTooHeavy(task, candidates_)) return;

    const std::uint32_t firstRow = finder.row / kWideRows * kWideRows;
    const std::uint32_t lastRow = std::min(firstRow + kWideRows, rows_.rows());
    ownGroup_.swap(candidates_);
    candidates_.clear();
    for (std::uint32_t row = firstRow; row < lastRow; ++row) {
        if (row != finder.row) {
            addCandidates(task, row, 0, rows_.pixels());
            continue;
        }
        addCandidates(task, row, 0, first);
        candidates_.insert(candidates_.end(), ownGroup_.begin(), ownGroup_.end());
        addCandidates(task, row, end, rows_.pixels());
    }
    keepMispredicted(task);
    keepTooHeavyGroups(task, size);
}

template <Integrand I>
bool NeighborReuse<I>::isTooHeavy(const Task& task, std::span<const Candidate> group) const {
    const double density = sumOfDensities(group);
    double ofPixel = 0;  // what its points receive, over what is too much
    for (std::size_t i = 0; i < group.size(); ++i) {
        if (i > 0 && task.slot(group[i]).pixel != task.slot(group[i - 1]).pixel) ofPixel = 0;
        const Rgb value = task.received(group[i], density);
        ofPixel += static_cast<double>(environment_.luminance(value)) /
                   task.offers.point(group[i].point).tooHeavyFrom;
        if (ofPixel > 1) return true;
    }
    return false;
}

template <Integrand I>
void NeighborReuse<I>::keepTooHeavyGroups(const Task& task, std::uint32_t size) {
    const auto groupOf = [&](const Candidate& c) {
        const BatchSlot& slot = task.slot(c);
        return std::pair(slot.row, slot.pixel / size);
    };
    auto kept = candidates_.begin();
    for (auto begin = kept; begin != candidates_.end();) {
        const auto end = std::find_if(begin, candidates_.end(), [&](const Candidate& c) {
            return groupOf(c) != groupOf(*begin);
        });
        const bool keeps = isTooHeavy(task, {begin, end});
        for (; begin != end; ++begin)
            if (keeps) *kept++ = *begin;
    }
    candidates_.erase(kept, candidates_.end());
}

template <Integrand I>
void NeighborReuse<I>::addCandidates(const Task& task, std::uint32_t row, std::uint32_t first,
                                     std::uint32_t end) {
    rows_.forEachPoint(row, first, end, [&](std::uint32_t point) { addCandidate(task, point); });
}

template <Integrand I>
void NeighborReuse<I>::addCandidate(const Task& task, std::uint32_t number) {
    const ClusterOffers::Point& point = task.offers.point(number);
    const typename I::Points& integrands = task.receivers.points;
    const Vec3f& direction = task.found.direction;
    if (!(point.samples > 0) || direction.dot(integrands.normal(number)) <= 0) return;
    const ClusterOffers::Offer& offer =
        offered_.at(point.cluster, [&] { return task.offers.offerOf(point.cluster, task.found); });
    if (offer.samples == 0) return;
    const double density =
        offer.density * point.samples + point.ofLobes * integrands.lobeDensity(number, direction);
    candidates_.push_back({number, density, offer.visible, number == task.found.finder});
}

/// A ray for each candidate that is not known to be; the others keep their order.
template <Integrand I>
void NeighborReuse<I>::keepMispredicted(const Task& task) {
    std::size_t kept = 0;
    RayPacket packet{};
    std::array<Candidate, RayPacket::kSize> queue;
    int queued = 0;
    const auto flush = [&] {
        const std::uint32_t visible = task.receivers.scene.visibility(packet, queued);
        for (int i = 0; i < queued; ++i) {
            const Candidate& c = queue[static_cast<std::size_t>(i)];
            ++task.receivers.estimates[c.point].reused;
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
        packet.set(queued, task.receivers.batch.points[c.point].place.rayOrigin,
                   task.found.direction);
        queue[static_cast<std::size_t>(queued++)] = c;
        if (queued == RayPacket::kSize) flush();
    }
    if (queued > 0) flush();
    candidates_.resize(kept);
}

/// Estimates of a pixel that receive the same misprediction err alike.
template <Integrand I>
void NeighborReuse<I>::contribute(const Task& task) {
    const double density = sumOfDensities(candidates_);
    received_.clear();
    for (const Candidate& c : candidates_) {
        received_.push_back(task.received(c, c.visible ? density : -density));
        if (c.visible && task.receivers.scene.tints())
            received_.back() *= task.receivers.scene.tint(
                task.receivers.batch.points[c.point].place.rayOrigin, task.found.direction);
    }
    for (const Candidate& c : candidates_) pixelReceived_[task.slot(c).pixel] = 0;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        const Candidate& c = candidates_[i];
        task.receivers.estimates[c.point].irradiance += received_[i];
        pixelReceived_[task.slot(c).pixel] += environment_.luminance(received_[i]);
    }
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        const Candidate& c = candidates_[i];
        const float own = environment_.luminance(received_[i]);
        Estimate& estimate = task.receivers.estimates[c.point];
        estimate.variance += own * own;
        estimate.covariance += own * (pixelReceived_[task.slot(c).pixel] - own);
    }
}

template class NeighborReuse<CosineIntegrand>;
template class NeighborReuse<LobeIntegrand>;

}  // namespace shadowcache
