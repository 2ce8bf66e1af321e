#include "bake/core/repeated_triangles.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "common/mesh/placed_mesh.h"
#include "common/mesh/point_table.h"

namespace shadowcache {

namespace {

/// What equal triangles have in common, and the number of one.
struct Entry {
    std::array<std::uint32_t, 3> corners;  ///< numbers of points, the least first
    std::uint32_t material;                ///< 0: none
    std::uint32_t triangle;

    auto operator<=>(const Entry&) const = default;

    bool repeats(const Entry& other) const {
        return corners == other.corners && material == other.material;
    }
};

std::uint32_t materialNumber(const TriangleMesh& mesh, std::uint32_t triangle) {
    const Material* material = materialOf(mesh, triangle);
    return material ? static_cast<std::uint32_t>(material - mesh.materials.data()) + 1 : 0;
}

}  // namespace

std::vector<bool> repeatedTriangles(const TriangleMesh& mesh) {
    if (mesh.report.duplicates == 0) return {};
    PointTable table(mesh.positions.size());
    std::vector<std::uint32_t> number;
    number.reserve(mesh.positions.size());
    for (const Vec3f& p : mesh.positions) number.push_back(table.add(p));
    std::vector<Entry> entries(directCount(mesh));
    for (std::uint32_t i = 0; i < entries.size(); ++i) {
        const Vec3i& t = mesh.triangles[i];
        Entry& entry = entries[i];
        for (int k = 0; k < 3; ++k)
            entry.corners[static_cast<std::size_t>(k)] = number[static_cast<std::size_t>(t[k])];
        // Turned, so that the winding stays: the sides that are seen depend on it.
        std::rotate(entry.corners.begin(), std::ranges::min_element(entry.corners),
                    entry.corners.end());
        if (isDoubleSided(mesh, i) && entry.corners[1] > entry.corners[2])
            std::swap(entry.corners[1], entry.corners[2]);
        entry.material = materialNumber(mesh, i);
        entry.triangle = i;
    }
    std::ranges::sort(entries);
    std::vector<bool> repeated(entries.size(), false);
    for (std::size_t i = 1; i < entries.size(); ++i)
        if (entries[i].repeats(entries[i - 1])) repeated[entries[i].triangle] = true;
    return repeated;
}

}  // namespace shadowcache
