#include "common/import/blurred.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
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

/// Blurred triangles are named where they are more than this of the set's surface, which is their
/// part in its light and its pictures, or more than that of its triangles, as something small that
/// was made to be seen from near. Less are the slivers that any set has some of.
constexpr double kLeastSurface = 1e-4, kLeastTriangles = 0.01;

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

/// Triangles and their surface.
struct Amount {
    std::size_t count = 0;
    double surface = 0;

    void add(const Amount& other) {
        count += other.count;
        surface += other.surface;
    }
    Amount scaled(double scale) const { return {count, surface * scale * scale}; }
};

struct Blurred {
    Amount all, blurred;
    double reach = 0;  ///< largest coordinate of a blurred one

    void add(const Amount& triangles, double coordinate) {
        if (triangles.count == 0) return;
        blurred.add(triangles);
        reach = std::max(reach, coordinate);
    }
    bool isMuch() const {
        return blurred.surface > kLeastSurface * all.surface ||
               static_cast<double>(blurred.count) >
                   kLeastTriangles * static_cast<double>(all.count);
    }
};

/// The triangles of an instanced mesh by their sizes, in ascending order.
class BySize {
public:
    void add(const Triangle& t) { triangles_.emplace_back(t.size(), t.area().length() / 2); }
    /// Once all are added.
    void sort() {
        std::sort(triangles_.begin(), triangles_.end());
        double sum = 0;
        for (auto& [size, surface] : triangles_) sum = surface += sum;
    }

    Amount smallerThan(double size) const {
        const auto end =
            std::lower_bound(triangles_.begin(), triangles_.end(), std::pair(size, 0.0));
        const auto count = static_cast<std::size_t>(end - triangles_.begin());
        return {count, count > 0 ? std::prev(end)->second : 0};
    }

private:
    /// Size, and surface; once they are sorted that of all up to it.
    std::vector<std::pair<double, double>> triangles_;
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
            const Amount amount{1, t.area().length() / 2};
            chunks[chunk.index].all.add(amount);
            if (t.isBlurred()) chunks[chunk.index].add(amount, t.reach());
        }
    });
    Blurred all;
    for (const Blurred& chunk : chunks) {
        all.all.add(chunk.all);
        all.add(chunk.blurred, chunk.reach);
    }

    std::vector<BySize> sizes(static_cast<std::size_t>(soup.groups) + 1);
    for (std::size_t i = 0; soup.groups > 0 && i < count; ++i)
        if (const int group = soup.groupOf(i); group != 0)
            sizes[static_cast<std::size_t>(group)].add(triangleOf(soup, i, Vec3d(0.0)));
    for (BySize& group : sizes) group.sort();
    for (const RawInstance& instance : soup.instances) {
        const BySize& group = sizes[static_cast<std::size_t>(instance.group)];
        const double reach = largest(instance.toWorld.position - origin);
        double scale = 0;
        for (const Vec3d& axis : instance.toWorld.axis) scale = std::max(scale, axis.length());
        if (!(scale > 0)) continue;  // hidden
        constexpr double kAny = std::numeric_limits<double>::infinity();
        all.all.add(group.smallerThan(kAny).scaled(scale));
        all.add(group.smallerThan(kLeastSize * reach / scale).scaled(scale), reach);
    }
    if (!all.isMuch()) return;
    const auto reach = static_cast<float>(all.reach);
    const float step = std::nextafter(reach, std::numeric_limits<float>::infinity()) - reach;
    soup.report.remarks[fmt::format(
        "triangles blurred, so far are they from the middle of the set for their size: positions "
        "there have a precision of {:.3g}, in the set's unit",
        step)] = all.blurred.count;
}

}  // namespace shadowcache
