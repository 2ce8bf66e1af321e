#include "common/math/direction_mesh.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

namespace shadowcache {
namespace {

/// Coarse levels are tabulated: 2.5 MB in all, which the second-level cache half holds, and a
/// descent to level 5 without a square root. Finer levels are worked out on the way down.
constexpr int kTableLevel = 5;

/// Corners of the icosahedron's 20 faces, counter-clockwise from outside, as indices into
/// corners().
constexpr std::array<std::array<int, 3>, 20> kFaces{
    {{0, 8, 4},  {0, 5, 10}, {2, 4, 9},  {2, 11, 5}, {1, 6, 8},   {1, 10, 7}, {3, 9, 6},
     {3, 7, 11}, {0, 1, 8},  {0, 10, 1}, {2, 9, 3},  {2, 3, 11},  {4, 5, 0},  {4, 2, 5},
     {6, 1, 7},  {6, 7, 3},  {8, 9, 4},  {8, 6, 9},  {10, 5, 11}, {10, 11, 7}}};

std::array<Vec3d, 12> corners() {
    constexpr double kG = std::numbers::phi;
    std::array<Vec3d, 12> v{Vec3d(1, kG, 0), Vec3d(-1, kG, 0), Vec3d(1, -kG, 0), Vec3d(-1, -kG, 0),
                            Vec3d(kG, 0, 1), Vec3d(kG, 0, -1), Vec3d(-kG, 0, 1), Vec3d(-kG, 0, -1),
                            Vec3d(0, 1, kG), Vec3d(0, -1, kG), Vec3d(0, 1, -kG), Vec3d(0, -1, -kG)};
    for (Vec3d& corner : v) corner.normalize();
    return v;
}

/// Midpoints of a cell's sides: the corners its children add.
struct Midpoints {
    Vec3d ab, bc, ca;
};

Midpoints midpoints(const SphericalTriangle& t) noexcept {
    return {(t.a + t.b).normalized(), (t.b + t.c).normalized(), (t.c + t.a).normalized()};
}

/// Children 0, 1, 2 sit at a, b, c; child 3 is the middle.
SphericalTriangle childTriangle(const SphericalTriangle& t, const Midpoints& m,
                                std::uint32_t child) noexcept {
    switch (child) {
        case 0:
            return {t.a, m.ab, m.ca};
        case 1:
            return {m.ab, t.b, m.bc};
        case 2:
            return {m.ca, m.bc, t.c};
        default:
            return {m.ab, m.bc, m.ca};
    }
}

/// Planes of the sides that the middle child shares with its siblings; plane i is positive toward
/// child i.
struct InnerPlanes {
    Vec3d planes[3];

    explicit InnerPlanes(const Midpoints& m) noexcept
        : planes{m.ab.cross(m.ca - m.ab), m.bc.cross(m.ab - m.bc), m.ca.cross(m.bc - m.ca)} {}

    /// Always names a child: a direction outside the cell goes to the nearest side's, by
    /// construction.
    std::uint32_t child(const Vec3d& w) const noexcept {
        std::uint32_t chosen = 3;
        for (std::uint32_t i = 0; i < 3; ++i) chosen = planes[i].dot(w) > 0.0 ? i : chosen;
        return chosen;
    }
};

class Tables {
public:
    Tables() {
        const std::array<Vec3d, 12> v = corners();
        for (const auto& [a, b, c] : kFaces) triangles_[0].push_back({v[a], v[b], v[c]});
        for (int level = 0; level < kTableLevel; ++level) split(level);
        for (std::uint32_t face = 0; face < kFaces.size(); ++face) nameFace(face);
    }

    const SphericalTriangle& triangle(int level, std::uint32_t index) const noexcept {
        return triangles_[level][index];
    }

    /// Face whose centre is nearest, which by symmetry is the face that holds `w`. The centres are
    /// the corners of a dodecahedron: (1, 1, 1), (g, 1/g, 0) and its two cyclic shifts, with all
    /// signs.
    std::uint32_t face(const Vec3d& w) const noexcept {
        const std::size_t signs =
            (w.x < 0.0 ? 1u : 0u) | (w.y < 0.0 ? 2u : 0u) | (w.z < 0.0 ? 4u : 0u);
        return faces_[kind(w)][signs];
    }

    /// Descends `levels` (<= kTableLevel) levels from the icosahedron's `cell`.
    std::uint32_t descend(int levels, std::uint32_t cell, const Vec3d& w) const noexcept {
        for (int level = 0; level < levels; ++level)
            cell = 4 * cell + planes_[level][cell].child(w);
        return cell;
    }

private:
    static std::size_t kind(const Vec3d& w) noexcept {
        constexpr double kG = std::numbers::phi;
        const double x = std::abs(w.x), y = std::abs(w.y), z = std::abs(w.z);
        const std::array<double, 4> cosines{x + y + z, kG * x + (kG - 1) * y, kG * y + (kG - 1) * z,
                                            kG * z + (kG - 1) * x};
        std::size_t best = 0;
        double largest = cosines[0];
        for (std::size_t i = 1; i < cosines.size(); ++i) {
            const bool better = cosines[i] > largest;
            best = better ? i : best;
            largest = better ? cosines[i] : largest;
        }
        return best;
    }

    void split(int level) {
        for (const SphericalTriangle& t : triangles_[level]) {
            const Midpoints m = midpoints(t);
            planes_[level].emplace_back(m);
            for (std::uint32_t child = 0; child < 4; ++child)
                triangles_[level + 1].push_back(childTriangle(t, m, child));
        }
    }

    /// Enters `face` under its centre's kind for every octant that the centre touches.
    void nameFace(std::uint32_t face) {
        const SphericalTriangle& t = triangles_[0][face];
        const Vec3d center = (t.a + t.b + t.c).normalized();
        for (std::size_t signs = 0; signs < 8; ++signs) {
            bool touches = true;
            for (int axis = 0; axis < 3; ++axis) {
                const double toward = (signs >> axis) & 1u ? -center[axis] : center[axis];
                touches = touches && toward > -0.1;  // a coordinate is 0 or at least 0.35
            }
            if (touches) faces_[kind(center)][signs] = face;
        }
    }

    std::array<std::vector<SphericalTriangle>, kTableLevel + 1> triangles_;
    std::array<std::vector<InnerPlanes>, kTableLevel> planes_;
    std::array<std::array<std::uint32_t, 8>, 4> faces_{};
};

const Tables& tables() {
    static const Tables instance;
    return instance;
}

}  // namespace

SphericalTriangle cellTriangle(int level, std::uint32_t index) noexcept {
    assert(level >= 0 && level <= kMaxDirectionLevel && index < cellCount(level));
    const int coarse = std::min(level, kTableLevel);
    SphericalTriangle t = tables().triangle(coarse, ancestorCell(index, level, coarse));
    for (int l = coarse + 1; l <= level; ++l)
        t = childTriangle(t, midpoints(t), ancestorCell(index, level, l) & 3u);
    return t;
}

Vec3d cellCenter(int level, std::uint32_t index) noexcept {
    const SphericalTriangle t = cellTriangle(level, index);
    return (t.a + t.b + t.c).normalized();
}

CellCap cellCap(int level, std::uint32_t index) noexcept {
    const SphericalTriangle t = cellTriangle(level, index);
    const Vec3d axis = (t.a + t.b + t.c).normalized();
    return {axis, std::acos(std::min({axis.dot(t.a), axis.dot(t.b), axis.dot(t.c)}))};
}

std::uint32_t locateCell(int level, const Vec3d& direction) noexcept {
    assert(level >= 0 && level <= kMaxDirectionLevel);
    const Tables& table = tables();
    const int coarse = std::min(level, kTableLevel);
    std::uint32_t cell = table.descend(coarse, table.face(direction), direction);
    if (level == coarse) return cell;
    SphericalTriangle t = table.triangle(coarse, cell);
    for (int l = coarse; l < level; ++l) {
        const Midpoints m = midpoints(t);
        const std::uint32_t child = InnerPlanes(m).child(direction);
        t = childTriangle(t, m, child);
        cell = 4 * cell + child;
    }
    return cell;
}

}  // namespace shadowcache
