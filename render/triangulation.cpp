#include "render/triangulation.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "common/parallel.h"

namespace shadowcache {

namespace {

/// Sums over the texels whose centres a cell holds.
struct Sums {
    double area = 0, power = 0, square = 0;
    Vec3d flux{0, 0, 0};

    void operator+=(const Sums& more) {
        area += more.area;
        power += more.power;
        square += more.square;
        flux += more.flux;
    }
    /// Variance of the luminance, integrated over the cell.
    double variance() const { return area > 0 ? std::max(0.0, square - power * power / area) : 0; }
};

/// Sums per cell of every level up to `finest`.
std::vector<std::vector<Sums>> sumLevels(const Environment& environment, int finest) {
    std::vector<std::vector<Sums>> levels(static_cast<std::size_t>(finest) + 1);
    for (int l = 0; l <= finest; ++l) levels[static_cast<std::size_t>(l)].resize(cellCount(l));
    // Texels are sorted by cells of the environment's level: disjoint parts of every finer level.
    const int own = std::min(finest, Environment::kLevel);
    parallelFor(cellCount(Environment::kLevel), 256, [&](const Chunk& chunk) {
        for (std::size_t c = chunk.begin; c < chunk.end; ++c) {
            const auto range = environment.texelsOf(static_cast<std::uint32_t>(c));
            for (std::uint32_t i = range[0]; i < range[1]; ++i) {
                const Environment::Texel t = environment.texel(i);
                const auto y = static_cast<double>(environment.luminance(t.radiance));
                const auto area = static_cast<double>(t.solidAngle);
                const Sums sums{area, y * area, y * y * area, Vec3d(t.center) * (y * area)};
                std::uint32_t cell = static_cast<std::uint32_t>(c);
                if (finest > Environment::kLevel) {
                    const std::uint32_t fine = locateCell(finest, Vec3d(t.center));
                    for (int l = Environment::kLevel + 1; l <= finest; ++l) {
                        // A rounding at a border must not leave this thread's part.
                        const std::uint32_t at = ancestorCell(fine, finest, l);
                        if (ancestorCell(at, l, Environment::kLevel) == cell)
                            levels[static_cast<std::size_t>(l)][at] += sums;
                    }
                }
                if (own == Environment::kLevel) levels[Environment::kLevel][c] += sums;
            }
        }
    });
    if (finest < Environment::kLevel) {
        for (std::uint32_t c = 0; c < cellCount(Environment::kLevel); ++c) {
            const auto range = environment.texelsOf(c);
            for (std::uint32_t i = range[0]; i < range[1]; ++i) {
                const Environment::Texel t = environment.texel(i);
                const auto y = static_cast<double>(environment.luminance(t.radiance));
                const auto area = static_cast<double>(t.solidAngle);
                levels[static_cast<std::size_t>(finest)]
                      [ancestorCell(c, Environment::kLevel, finest)] +=
                    {area, y * area, y * y * area, Vec3d(t.center) * (y * area)};
            }
        }
    }
    for (int l = own - 1; l >= 0; --l)
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
    t.axis = cellCenter(level, cell);
    t.radius = std::acos(
        std::min({t.axis.dot(t.corners.a), t.axis.dot(t.corners.b), t.axis.dot(t.corners.c)}));
    t.area = solidAngle(t.corners);
    t.flux = sums.flux;
    t.power = sums.power;
    // Texels overlap triangles that do not hold their centres; a lit one must keep the density
    // positive.
    constexpr double kShare = 2e-2;
    t.floor = kShare * static_cast<double>(environment.maxLuminance(t.axis, t.radius));
    return t;
}

}  // namespace

std::vector<MapTriangle> triangulate(const Environment& environment, int count, int minLevel,
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
