#pragma once

#include <cstdint>

#include "common/math/spherical_triangle.h"

namespace shadowcache {

/// Finest level of the icosahedral hierarchy of direction cells. Level l cuts the sphere into 20 *
/// 4^l spherical triangles. Cell i of level l has the children 4i .. 4i+3 at level l+1, so the
/// descendants of a cell are contiguous at every level. Corners of children are the normalised
/// midpoints of the parent's sides. Orientation and order are part of the cache's file format:
/// never change them.
inline constexpr int kMaxDirectionLevel = 9;

/// Number of cells of a level.
constexpr std::uint32_t cellCount(int level) {
    return 20u << (2 * level);
}

/// Ancestor at `level` of cell `index` of level `fine` (>= level).
constexpr std::uint32_t ancestorCell(std::uint32_t index, int fine, int level) {
    return index >> (2 * (fine - level));
}

/// Triangle of cell `index` (< cellCount(level)), level in 0 .. kMaxDirectionLevel.
SphericalTriangle cellTriangle(int level, std::uint32_t index) noexcept;

/// Unit vector at the centroid of cell `index` (< cellCount(level)) of a level.
Vec3d cellCenter(int level, std::uint32_t index) noexcept;

/// A circle around a cell's centroid that holds the cell.
struct CellCap {
    Vec3d axis;    ///< unit vector: cellCenter()
    double angle;  ///< between the axis and the farthest corner [rad]
};
/// The smallest of these circles, for cell `index` (< cellCount(level)) of a level.
CellCap cellCap(int level, std::uint32_t index) noexcept;

/// Cell of `level` that holds `direction` (unit, within 1e-6); on a border, one of its neighbours.
std::uint32_t locateCell(int level, const Vec3d& direction) noexcept;

}  // namespace shadowcache
