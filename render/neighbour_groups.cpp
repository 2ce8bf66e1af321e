#include "render/neighbour_groups.h"

#include <algorithm>
#include <numeric>

#include "common/sequence.h"

namespace shadowcache {

namespace {

/// Borders of groups are ragged by this much of the tile: errors within a group are alike, and
/// straight borders would be seen.
constexpr float kShake = 0.2f;

}  // namespace

void NeighbourGroups::group(std::span<const ShadingPoint> points) {
    ends_.clear();
    order_.resize(points.size());
    std::iota(order_.begin(), order_.end(), 0u);
    if (points.empty()) return;
    makePlaces(points);
    split(0, points.size());
}

void NeighbourGroups::makePlaces(std::span<const ShadingPoint> points) {
    Vec3d low = points[0].position, high = low;
    for (const ShadingPoint& p : points)
        for (int a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p.position[a]);
            high[a] = std::max(high[a], p.position[a]);
        }
    const Vec3d extent = high - low;
    const double scale = 1 / std::max({extent.x, extent.y, extent.z, 1e-30});
    places_.clear();
    for (const ShadingPoint& p : points) {
        Place place;
        const std::uint64_t hash = hashWords(p.seed, 83);
        for (int a = 0; a < 3; ++a) {
            const float shake =
                kShake * toUnitFloat(static_cast<std::uint32_t>(hash >> (20 * a)) << 12);
            place[static_cast<std::size_t>(a)] =
                static_cast<float>((p.position[a] - low[a]) * scale) + shake;
            place[static_cast<std::size_t>(a) + 3] = p.normal[a] + shake;
        }
        places_.push_back(place);
    }
}

/// Halves the range along its widest axis until it is one group.
void NeighbourGroups::split(std::size_t begin, std::size_t end) {
    if (end - begin <= kMostPoints) {
        ends_.push_back(end);
        return;
    }
    const std::size_t axis = widestAxis(begin, end), middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
        return std::pair(places_[a][axis], a) < std::pair(places_[b][axis], b);
    });
    split(begin, middle);
    split(middle, end);
}

std::size_t NeighbourGroups::widestAxis(std::size_t begin, std::size_t end) const {
    Place low = places_[order_[begin]], high = low;
    for (std::size_t i = begin; i < end; ++i)
        for (std::size_t a = 0; a < low.size(); ++a) {
            low[a] = std::min(low[a], places_[order_[i]][a]);
            high[a] = std::max(high[a], places_[order_[i]][a]);
        }
    std::size_t widest = 0;
    for (std::size_t a = 1; a < low.size(); ++a)
        if (high[a] - low[a] > high[widest] - low[widest]) widest = a;
    return widest;
}

}  // namespace shadowcache
