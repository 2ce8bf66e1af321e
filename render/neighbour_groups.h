#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/estimator.h"

namespace shadowcache {

/// The points of a tile in groups whose members are near one another in the set and face alike, so
/// that what one finds is worth telling the others. Decided by the points alone. Arrays are reused
/// from tile to tile.
class NeighbourGroups {
public:
    /// Fewer share less, more trace more rays for one another.
    static constexpr std::size_t kMostPoints = 64;

    void group(std::span<const ShadingPoint> points);

    std::size_t size() const { return ends_.size(); }
    /// Numbers of the points in group `g`.
    std::span<const std::uint32_t> operator[](std::size_t g) const {
        const std::size_t begin = g == 0 ? 0 : ends_[g - 1];
        return std::span(order_).subspan(begin, ends_[g] - begin);
    }

private:
    /// Position in extents of the tile, normal; both a little shaken.
    using Place = std::array<float, 6>;

    void makePlaces(std::span<const ShadingPoint> points);
    void split(std::size_t begin, std::size_t end);
    std::size_t widestAxis(std::size_t begin, std::size_t end) const;

    std::vector<Place> places_;
    std::vector<std::uint32_t> order_;
    std::vector<std::size_t> ends_;
};

}  // namespace shadowcache
