#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/light/environment.h"

namespace shadowcache {

/// A map cut into cells of the direction mesh with about the same light each: the brightest cell is
/// split until there are enough. Cells of Environment::kLevel stay whole, however bright; dark
/// cells are no tiles. Immutable, thread-safe.
class LightTiles {
public:
    /// Tiles, at most.
    static constexpr std::size_t kMost = 256;

    /// A cell of the direction mesh.
    struct Tile {
        int level;
        std::uint32_t cell;
    };

    /// @param count  tiles wanted, 20 .. kMost
    LightTiles(const Environment& environment, std::size_t count);

    std::size_t size() const { return tiles_.size(); }
    /// Tiles are in the order of their cells, so neighbours are near each other.
    const Tile& operator[](std::size_t i) const { return tiles_[i]; }

    /// Luminance integral of each tile [radiance sr], positive.
    std::span<const float> light() const { return light_; }

    /// Number of the tile that a lit cell of Environment::kLevel belongs to.
    std::size_t tileOf(std::uint32_t cell) const { return tileOfCell_[cell]; }

    /// Estimates the mean of (n . w)+ over the light of each tile; positive for every tile that is
    /// partly above the horizon.
    ///
    /// @param out  size() numbers
    void cosines(const Vec3f& normal, std::span<float> out) const noexcept;

private:
    void addTile(const Environment& environment, const Tile& tile);

    std::vector<Tile> tiles_;
    std::vector<float> light_;
    std::vector<float> mean_[3];  ///< mean direction of the light, no unit vector
    std::vector<float> reach_;    ///< half width of n . w over the light, for n at right angles
    std::vector<float> axis_[3], sinRadius_;  ///< around all of the tile
    std::vector<std::uint8_t> tileOfCell_;
};

}  // namespace shadowcache
