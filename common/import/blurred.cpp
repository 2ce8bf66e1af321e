#include "common/import/blurred.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/base/parallel.h"

namespace shadowcache {

namespace {

constexpr std::size_t kBlurChunk = 1 << 16;

/// Of a triangle's largest coordinate. Rays start up to as far off a surface (Scene::rayOrigin),
/// and see nothing that is smaller.
constexpr double kLeastSize = 0x1p-19;
/// Of a triangle's area vector: a change of more is another form.
constexpr double kChange = 0.02;
/// Of height to length: narrower ones hardly count, and change by any rounding.
constexpr double kNarrow = 1e-3;

double largest(const Vec3d& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

struct Triangle {
    Vec3d a, b, c;

    double size() const { return std::max({largest(b - a), largest(c - b), largest(a - c)}); }
    Vec3d area() const { return (b - a).cross(c - a); }
    double reach() const { return std::max({largest(a), largest(b), largest(c)}); }

    bool isBlurred() const {
        const Vec3d exact = area();
        const double length = size();
        if (!(exact.length() > kNarrow * length * length)) return false;
        if (length < kLeastSize * reach()) return true;
        const auto rounded = [](const Vec3d& p) { return Vec3d(Vec3f(p)); };
        const Triangle stored{rounded(a), rounded(b), rounded(c)};
        return (stored.area() - exact).length() > kChange * exact.length();
    }
};

struct Blurred {
    std::size_t count = 0;
    double reach = 0;  ///< largest coordinate of one

    void add(std::size_t triangles, double coordinate) {
        if (triangles == 0) return;
        count += triangles;
        reach = std::max(reach, coordinate);
    }
};

Triangle triangleOf(const MeshSoup& soup, std::size_t i, const Vec3d& origin) {
    const auto corner = [&](std::size_t k) { return soup.vertices[soup.triangles[i][k]] - origin; };
    return {corner(0), corner(1), corner(2)};
}

}  // namespace

void countBlurred(const Vec3d& origin, MeshSoup& soup) {
    const std::size_t count = soup.triangles.size();
    std::vector<Blurred> chunks(count / kBlurChunk + 1);
    parallelFor(count, kBlurChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const bool isLocal = soup.groupOf(i) != 0;
            const Triangle t = triangleOf(soup, i, isLocal ? Vec3d(0.0) : origin);
            chunks[chunk.index].add(t.isBlurred() ? 1 : 0, t.reach());
        }
    });
    Blurred all;
    for (const Blurred& chunk : chunks) all.add(chunk.count, chunk.reach);

    // Instances, by the sizes of their triangles in ascending order.
    std::vector<std::vector<double>> sizes(static_cast<std::size_t>(soup.groups) + 1);
    for (std::size_t i = 0; soup.groups > 0 && i < count; ++i)
        if (const int group = soup.groupOf(i); group != 0)
            sizes[static_cast<std::size_t>(group)].push_back(
                triangleOf(soup, i, Vec3d(0.0)).size());
    for (std::vector<double>& group : sizes) std::sort(group.begin(), group.end());
    for (const RawInstance& instance : soup.instances) {
        const std::vector<double>& group = sizes[static_cast<std::size_t>(instance.group)];
        const double reach = largest(instance.toWorld.position - origin);
        double scale = 0;
        for (const Vec3d& axis : instance.toWorld.axis) scale = std::max(scale, axis.length());
        if (!(scale > 0)) continue;  // hidden
        const auto end = std::lower_bound(group.begin(), group.end(), kLeastSize * reach / scale);
        all.add(static_cast<std::size_t>(end - group.begin()), reach);
    }
    if (all.count == 0) return;
    const auto reach = static_cast<float>(all.reach);
    const float step = std::nextafter(reach, std::numeric_limits<float>::infinity()) - reach;
    soup.report.remarks[fmt::format(
        "triangles blurred, so far are they from the middle of the set for their size: positions "
        "there have a precision of {:.3g}, in the set's unit",
        step)] = all.count;
}

}  // namespace shadowcache
