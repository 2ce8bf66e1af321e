#include "render/estimators/dome_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace shadowcache {

namespace {

/// Places of a cell, at least.
constexpr std::size_t kLeastPlaces = 32;
/// A length of the unit normals in standard deviations of the places on the film and in the world.
constexpr float kNormalScale = 1;
/// Rays that the visibility of the cell around a cell is worth.
constexpr float kPriorRays = 16;
/// Visibility before anything is known.
constexpr float kFirstGuess = 0.5f;

}  // namespace

/// What the tree is grown from.
struct DomeCells::Learner {
    std::vector<Key> keys;  ///< of the places
    std::span<const TileRay> rays;
    std::span<const std::uint8_t> counts;
    std::size_t raysAPlace;

    /// Dimension in which `places` vary most, and their mean there.
    std::pair<int, float> widest(std::span<const std::uint32_t> places) const {
        std::pair<int, float> found{0, 0.0f};
        double most = -1;
        for (std::size_t d = 0; d < kDimensions; ++d) {
            double sum = 0, squares = 0;
            for (const std::uint32_t i : places) {
                const auto x = static_cast<double>(keys[i][d]);
                sum += x;
                squares += x * x;
            }
            const double mean = sum / static_cast<double>(places.size());
            const double variance = squares / static_cast<double>(places.size()) - mean * mean;
            if (variance <= most) continue;
            most = variance;
            found = {static_cast<int>(d), static_cast<float>(mean)};
        }
        return found;
    }

    /// Posterior mean of the tiles' visibility, with that of the larger cell as the prior.
    std::vector<float> learn(std::span<const std::uint32_t> places,
                             const std::vector<float>& prior) const {
        std::vector<float> traced(prior.size(), 0.0f), visible(prior.size(), 0.0f);
        for (const std::uint32_t i : places)
            for (const TileRay& ray : rays.subspan(i * raysAPlace, counts[i])) {
                traced[ray.tile] += 1;
                visible[ray.tile] += ray.visible ? 1.0f : 0.0f;
            }
        for (std::size_t t = 0; t < prior.size(); ++t)
            visible[t] = (visible[t] + kPriorRays * prior[t]) / (traced[t] + kPriorRays);
        return visible;
    }
};

DomeCells::DomeCells(std::span<const ShadingPoint> places, std::span<const TileRay> rays,
                     std::span<const std::uint8_t> counts, std::size_t raysAPlace,
                     std::size_t tiles)
    : tiles_(tiles), nodes_(1) {
    setScale(places);
    Learner learner{{}, rays, counts, raysAPlace};
    learner.keys.reserve(places.size());
    for (const ShadingPoint& place : places) learner.keys.push_back(keyOf(place));
    std::vector<std::uint32_t> all(places.size());
    std::iota(all.begin(), all.end(), 0u);
    grow(0, all, std::vector<float>(tiles, kFirstGuess), learner);
}

/// So that the places have unit variance on the film, and in the world.
void DomeCells::setScale(std::span<const ShadingPoint> places) {
    if (places.empty()) return;
    const auto count = static_cast<double>(places.size());
    double film[2] = {0, 0};
    for (const ShadingPoint& p : places) {
        origin_ += p.place.position / count;
        film[0] += p.slot.filmX / count;
        film[1] += p.slot.filmY / count;
    }
    double filmVariance = 0, worldVariance = 0;
    for (const ShadingPoint& p : places) {
        filmVariance +=
            (std::pow(p.slot.filmX - film[0], 2) + std::pow(p.slot.filmY - film[1], 2)) / count;
        worldVariance += (p.place.position - origin_).length2() / count;
    }
    filmScale_ = filmVariance > 0 ? 1 / std::sqrt(filmVariance) : 0;
    worldScale_ = worldVariance > 0 ? 1 / std::sqrt(worldVariance) : 0;
}

DomeCells::Key DomeCells::keyOf(const ShadingPoint& point) const noexcept {
    const Vec3f world((point.place.position - origin_) * worldScale_);
    const Vec3f normal = point.place.normal * kNormalScale;
    return {static_cast<float>(point.slot.filmX * filmScale_),
            static_cast<float>(point.slot.filmY * filmScale_),
            world.x,
            world.y,
            world.z,
            normal.x,
            normal.y,
            normal.z};
}

void DomeCells::grow(std::size_t node, std::span<std::uint32_t> places,
                     const std::vector<float>& prior, const Learner& learner) {
    const std::vector<float> visibility = learner.learn(places, prior);
    if (places.size() >= 2 * kLeastPlaces) {
        const auto [dimension, threshold] = learner.widest(places);
        const auto second =
            std::partition(places.begin(), places.end(),
                           [&, d = static_cast<std::size_t>(dimension), mean = threshold](
                               std::uint32_t i) { return learner.keys[i][d] < mean; });
        const auto below = static_cast<std::size_t>(second - places.begin());
        if (below >= kLeastPlaces / 2 && places.size() - below >= kLeastPlaces / 2) {
            nodes_[node] = {dimension, threshold, static_cast<std::uint32_t>(nodes_.size())};
            const std::size_t first = nodes_.size();
            nodes_.resize(first + 2);
            grow(first, places.first(below), visibility, learner);
            grow(first + 1, places.subspan(below), visibility, learner);
            return;
        }
    }
    nodes_[node].next = static_cast<std::uint32_t>(size());
    visibility_.insert(visibility_.end(), visibility.begin(), visibility.end());
}

std::span<const float> DomeCells::visibility(const ShadingPoint& point) const noexcept {
    const Key key = keyOf(point);
    std::size_t i = 0;
    while (nodes_[i].dimension >= 0)
        i = nodes_[i].next +
            (key[static_cast<std::size_t>(nodes_[i].dimension)] < nodes_[i].threshold ? 0u : 1u);
    return {&visibility_[nodes_[i].next * tiles_], tiles_};
}

}  // namespace shadowcache
