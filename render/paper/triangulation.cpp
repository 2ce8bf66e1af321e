#include "render/paper/triangulation.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <unordered_map>

#include "common/base/parallel.h"

namespace shadowcache {

namespace {

/// Sums over the parts of texels that lie in a cell.
struct Sums {
    double area = 0, luminanceIntegral = 0, square = 0;
    Vec3d firstMoment{0, 0, 0};

    void operator+=(const Sums& more) {
        area += more.area;
        luminanceIntegral += more.luminanceIntegral;
        square += more.square;
        firstMoment += more.firstMoment;
    }
    /// Variance of the luminance, integrated over the cell.
    double variance() const {
        return area > 0 ? std::max(0.0, square - luminanceIntegral * luminanceIntegral / area) : 0;
    }
};

/// Intervals along a side of a texel that lies in several triangles.
constexpr int kSubdivisions = 8;

using SumsByCell = std::unordered_map<std::uint32_t, Sums>;

Sums sumsOf(const Vec3d& direction, double luminance, double area) {
    return {area, luminance * area, luminance * luminance * area, direction * (luminance * area)};
}

/// Intervals along a side of the parts that a texel is divided into: many where it is brighter than
/// the map in the mean, as what is missed of it is missed by the density.
int intervalsOf(const Environment& environment, double luminance, double area, int finest) {
    if (luminance > environment.luminanceIntegral() / (4 * kPi)) return kSubdivisions;
    return area > kPi / cellCount(finest) ? kSubdivisions / 2 : 1;
}

/// Adds texel `i` to the cells of level `finest` that it lies in; to the one that holds its middle
/// if it is dull and small.
void addTexel(const Environment& environment, std::size_t i, int finest, SumsByCell& sums) {
    const Environment::Texel t = environment.texel(i);
    const auto luminance = static_cast<double>(environment.luminance(t.radiance));
    const auto area = static_cast<double>(t.solidAngle);
    const int n = intervalsOf(environment, luminance, area, finest);
    const std::uint32_t cell = locateCell(finest, Vec3d(t.center));
    bool spread = false;
    if (n > 1)
        for (const double x : {0.0, 1.0})
            for (const double y : {0.0, 1.0})
                spread = spread || locateCell(finest, environment.placeIn(i, x, y)) != cell;
    if (!spread) {
        sums[cell] += sumsOf(Vec3d(t.center), luminance, area);
        return;
    }
    // The trapezoidal rule: its points stand on the texel's sides, so that no sliver along one of
    // them is missed, however thin.
    for (int y = 0; y <= n; ++y)
        for (int x = 0; x <= n; ++x) {
            const Vec3d place =
                environment.placeIn(i, static_cast<double>(x) / n, static_cast<double>(y) / n);
            const double weight = (x % n == 0 ? 0.5 : 1.0) * (y % n == 0 ? 0.5 : 1.0);
            sums[locateCell(finest, place)] += sumsOf(place, luminance, area * weight / (n * n));
        }
}

/// Sums per cell of every level up to `finest`.
std::vector<std::vector<Sums>> sumLevels(const Environment& environment, int finest) {
    std::vector<std::vector<Sums>> levels(static_cast<std::size_t>(finest) + 1);
    for (int l = 0; l <= finest; ++l) levels[static_cast<std::size_t>(l)].resize(cellCount(l));
    constexpr std::size_t kChunk = 8192;
    std::vector<SumsByCell> parts((environment.texelCount() + kChunk - 1) / kChunk);
    parallelFor(environment.texelCount(), kChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            addTexel(environment, i, finest, parts[chunk.index]);
    });
    for (const SumsByCell& part : parts)
        for (const auto& [cell, sums] : part) levels.back()[cell] += sums;
    for (int l = finest - 1; l >= 0; --l)
        for (std::size_t c = 0; c < cellCount(l); ++c)
            for (std::size_t k = 4 * c; k < 4 * c + 4; ++k)
                levels[static_cast<std::size_t>(l)][c] +=
                    levels[static_cast<std::size_t>(l) + 1][k];
    return levels;
}

MapTriangle makeTriangle(const Environment& environment, int level, std::uint32_t cell,
                         const Sums& sums) {
    MapTriangle t;
    t.level = level;
    t.cell = cell;
    t.corners = cellTriangle(level, cell);
    const CellCap cap = cellCap(level, cell);
    t.axis = cap.axis;
    t.radius = cap.angle;
    t.sinRadius = std::sin(t.radius);
    t.area = solidAngle(t.corners);
    t.firstMoment = sums.firstMoment;
    t.luminanceIntegral = sums.luminanceIntegral;
    // A corner of the triangle may reach into a texel between the points: as if a part of the
    // brightest texel nearby were in it, the density is positive all the same. More, such as a
    // share of that luminance over all of a large triangle beside a lamp, would take the samples.
    const double part = 2 * kPi * kPi / static_cast<double>(environment.texelCount()) /
                        (kSubdivisions * kSubdivisions);
    t.floor = part * static_cast<double>(environment.maxLuminance(t.axis, t.radius));
    return t;
}

}  // namespace

std::vector<MapTriangle> triangulateMap(const Environment& environment, int count, int minLevel,
                                        int maxLevel) {
    while (minLevel > 0 && cellCount(minLevel) > static_cast<std::uint32_t>(count)) --minLevel;
    const auto levels = sumLevels(environment, maxLevel);
    struct Entry {
        double variance;
        int level;
        std::uint32_t cell;
        bool operator<(const Entry& other) const {
            if (variance != other.variance) return variance < other.variance;
            return level != other.level ? level > other.level : cell > other.cell;
        }
    };
    const auto entry = [&](int level, std::uint32_t cell) {
        return Entry{levels[static_cast<std::size_t>(level)][cell].variance(), level, cell};
    };
    std::priority_queue<Entry> heap;
    std::vector<Entry> leaves;
    for (std::uint32_t c = 0; c < cellCount(minLevel); ++c) heap.push(entry(minLevel, c));
    while (!heap.empty()) {
        const Entry top = heap.top();
        heap.pop();
        const std::size_t total = leaves.size() + heap.size() + 1;
        if (top.level < maxLevel && total + 3 <= static_cast<std::size_t>(count)) {
            for (std::uint32_t k = 0; k < 4; ++k) heap.push(entry(top.level + 1, 4 * top.cell + k));
        } else {
            leaves.push_back(top);
        }
    }
    std::sort(leaves.begin(), leaves.end(), [](const Entry& a, const Entry& b) {
        const auto first = [](const Entry& e) {
            return std::uint64_t{e.cell} << (2 * (kMaxDirectionLevel - e.level));
        };
        return first(a) < first(b);
    });
    std::vector<MapTriangle> triangles(leaves.size());
    parallelFor(leaves.size(), 256, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            triangles[i] =
                makeTriangle(environment, leaves[i].level, leaves[i].cell,
                             levels[static_cast<std::size_t>(leaves[i].level)][leaves[i].cell]);
    });
    return triangles;
}

}  // namespace shadowcache
