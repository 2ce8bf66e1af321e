#include "common/import/triangulate.h"

#include <algorithm>
#include <cmath>

namespace shadowcache {

namespace {

using Point = Imath::V2d;

/// Sum of the cross products around the polygon: twice its area along its normal. [Newell]
Vec3d polygonNormal(std::span<const Vec3d> corners) {
    Vec3d sum(0.0);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        sum += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
    }
    return sum;
}

/// Drops the axis nearest to the normal, keeping the polygon counter-clockwise.
std::vector<Point> project(std::span<const Vec3d> corners) {
    const Vec3d n = polygonNormal(corners);
    const Vec3d size(std::abs(n.x), std::abs(n.y), std::abs(n.z));
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    const bool flip = n[axis] < 0.0;
    std::vector<Point> points;
    points.reserve(corners.size());
    for (const Vec3d& corner : corners) {
        const Vec3d local = corner - corners[0];
        points.push_back(flip ? Point(local[v], local[u]) : Point(local[u], local[v]));
    }
    return points;
}

/// Twice the signed area; positive if counter-clockwise.
double area(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon while ears are cut off: a ring of the corners that are left.
class Ring {
public:
    explicit Ring(std::vector<Point> points) : points_(std::move(points)) {
        const auto count = static_cast<std::uint32_t>(points_.size());
        for (std::uint32_t i = 0; i < count; ++i) {
            previous_.push_back(i == 0 ? count - 1 : i - 1);
            next_.push_back(i + 1 == count ? 0 : i + 1);
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            if (cornerArea(i) < 0.0) reflex_.push_back(i);
        }
    }

    bool convex() const { return reflex_.empty(); }
    std::uint32_t next(std::uint32_t i) const { return next_[i]; }
    std::array<std::uint32_t, 3> triangle(std::uint32_t i) const {
        return {previous_[i], i, next_[i]};
    }

    /// Whether the triangle at corner i has area and no reflex corner lies in it.
    bool isEar(std::uint32_t i) const {
        if (!(cornerArea(i) > 0.0)) return false;
        const Point& a = points_[previous_[i]];
        const Point& b = points_[i];
        const Point& c = points_[next_[i]];
        return std::none_of(reflex_.begin(), reflex_.end(), [&](std::uint32_t k) {
            const Point& p = points_[k];
            // Seams that join a hole to the outline repeat positions; those do not block.
            if (p == a || p == b || p == c) return false;
            return area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0;
        });
    }

    /// Takes corner i out; returns the corner before it.
    std::uint32_t cut(std::uint32_t i) {
        const std::uint32_t before = previous_[i];
        const std::uint32_t after = next_[i];
        next_[before] = after;
        previous_[after] = before;
        std::erase_if(reflex_, [&](std::uint32_t k) {
            return k == i || ((k == before || k == after) && cornerArea(k) >= 0.0);
        });
        return before;
    }

private:
    double cornerArea(std::uint32_t i) const {
        return area(points_[previous_[i]], points_[i], points_[next_[i]]);
    }

    std::vector<Point> points_;
    std::vector<std::uint32_t> previous_;
    std::vector<std::uint32_t> next_;
    std::vector<std::uint32_t> reflex_;
};

}  // namespace

bool triangulate(std::span<const Vec3d> corners, std::vector<std::array<std::uint32_t, 3>>& out) {
    const auto count = static_cast<std::uint32_t>(corners.size());
    if (count == 3) {
        out.push_back({0, 1, 2});
        return true;
    }
    Ring ring(project(corners));
    if (ring.convex()) {
        for (std::uint32_t i = 1; i + 1 < count; ++i) out.push_back({0, i, i + 1});
        return true;
    }
    if (count > kMaxConcaveCorners) return false;

    std::uint32_t corner = 1;
    for (std::uint32_t left = count; left > 3; --left) {
        std::uint32_t tried = 0;
        while (tried < left && !ring.isEar(corner)) {
            corner = ring.next(corner);
            ++tried;
        }
        // Without an ear (a self-crossing or flat rest) any corner goes, so that the count holds.
        out.push_back(ring.triangle(corner));
        corner = ring.next(ring.cut(corner));
    }
    out.push_back(ring.triangle(corner));
    return true;
}

}  // namespace shadowcache
