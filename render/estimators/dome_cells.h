#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/estimators/shading_point.h"

namespace shadowcache {

/// A shadow ray toward a tile of the map.
struct TileRay {
    std::uint8_t tile;
    bool visible;
};

/// Learned from the rays of some places on the film: the visibility of the map's tiles, in cells of
/// places that are near each other on the film, in the world and in normal. Cells are the leaves of
/// a kd-tree, so that each has about the same number of places. Immutable once built, thread-safe.
class DomeCells {
public:
    /// @param rays  of place i: rays[i * raysAPlace] and the next; those past counts[i] are unused
    DomeCells(std::span<const ShadingPoint> places, std::span<const TileRay> rays,
              std::span<const std::uint8_t> counts, std::size_t raysAPlace, std::size_t tiles);

    std::size_t size() const { return visibility_.size() / tiles_; }

    /// Expected visible share of each tile, seen from the cell of `point`.
    std::span<const float> visibility(const ShadingPoint& point) const noexcept;

private:
    static constexpr int kDimensions = 8;
    using Key = std::array<float, kDimensions>;

    struct Node {
        int dimension = -1;      ///< that it splits; -1: a cell
        float threshold = 0;     ///< from which on a key belongs to the second child
        std::uint32_t next = 0;  ///< first child, the second is next to it; number of the cell
    };
    struct Learner;

    Key keyOf(const ShadingPoint& point) const noexcept;
    void setScale(std::span<const ShadingPoint> places);
    void grow(std::size_t node, std::span<std::uint32_t> places, const std::vector<float>& parent,
              const Learner& learner);

    std::size_t tiles_;
    Vec3d origin_{0.0};
    double filmScale_ = 1, worldScale_ = 1;
    std::vector<Node> nodes_;
    std::vector<float> visibility_;  ///< tiles_ numbers a cell
};

}  // namespace shadowcache
