#include "common/import/tangents.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace shadowcache {

namespace {

/// `v` without what it has along `n`, of unit length; 0 if nothing is left.
Vec3d across(const Vec3d& v, const Vec3d& n) {
    const double size = n.length2();
    if (!(size > 0)) return Vec3d(0.0);
    const Vec3d rest = v - n * (n.dot(v) / size);
    const double length = rest.length();
    return length > 0 && std::isfinite(length) ? rest / length : Vec3d(0.0);
}

}  // namespace

std::vector<Tangent> deriveTangents(std::span<const Vec3d> positions,
                                    std::span<const Vec3d> normals, std::span<const Vec2f> places,
                                    std::span<const std::uint32_t> corners) {
    if (normals.empty()) return {};
    std::vector<Tangent> tangents(positions.size());
    std::vector<Vec3d> sums(positions.size(), Vec3d(0.0));
    std::vector<std::array<bool, 2>> found(positions.size(), {false, false});
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
        const std::array<std::size_t, 3> t{corners[i], corners[i + 1], corners[i + 2]};
        if (std::ranges::any_of(t, [&](std::size_t v) { return v >= positions.size(); })) continue;
        const Vec2f pq = places[t[1]] - places[t[0]], pr = places[t[2]] - places[t[0]];
        const auto area = static_cast<double>(pq.x * pr.y - pq.y * pr.x);
        if (!(std::abs(area) > 0)) continue;
        const Vec3d direction = ((positions[t[1]] - positions[t[0]]) * static_cast<double>(pr.y) -
                                 (positions[t[2]] - positions[t[0]]) * static_cast<double>(pq.y)) *
                                (area > 0 ? 1.0 : -1.0);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t v = t[k];
            const Vec3d& n = normals[v];
            const Vec3d ahead = across(positions[t[(k + 1) % 3]] - positions[v], n),
                        behind = across(positions[t[(k + 2) % 3]] - positions[v], n);
            sums[v] += across(direction, n) * std::acos(std::clamp(ahead.dot(behind), -1.0, 1.0));
            found[v][area > 0 ? 1 : 0] = true;
        }
    }
    for (std::size_t v = 0; v < tangents.size(); ++v) {
        const double length = sums[v].length();
        if (!(length > 0) || found[v][0] == found[v][1]) continue;
        // t points down in the picture.
        tangents[v] = {Vec3f(sums[v] / length), found[v][1] ? -1.0f : 1.0f};
    }
    return tangents;
}

}  // namespace shadowcache
