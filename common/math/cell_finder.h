#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/math/direction_mesh.h"

namespace shadowcache {

/// Finds the cells of one level that hold many directions, fast where one is near the next.
/// Immutable, thread-safe.
class CellFinder {
public:
    /// @param level  0 .. kMaxDirectionLevel; 48 bytes a cell
    explicit CellFinder(int level);

    /// Cell that holds the unit vector `w`; on a border, one of its neighbours.
    ///
    /// @param near  a cell near it
    std::uint32_t find(const Vec3f& w, std::uint32_t near) const noexcept {
        for (int step = 0; step < kMostSteps; ++step) {
            const Cell& cell = cells_[near];
            int outside = -1;
            for (int side = 0; side < 3; ++side)
                outside = cell.plane[static_cast<std::size_t>(side)].dot(w) < 0 ? side : outside;
            if (outside < 0) return near;
            near = cell.neighbor[static_cast<std::size_t>(outside)] / 4;
        }
        return locateCell(level_, Vec3d(w));
    }

private:
    /// Steps from cell to cell until a search from the icosahedron is the faster one.
    static constexpr int kMostSteps = 8;

    /// Side i is that between the corners i and i + 1.
    struct Cell {
        std::array<Vec3f, 3> plane;             ///< of each side, positive inside
        std::array<std::uint32_t, 3> neighbor;  ///< beyond each side: 4 cell + its side
    };

    void addNeighbors(std::vector<Cell>& children) const;

    int level_;
    std::vector<Cell> cells_;
};

}  // namespace shadowcache
