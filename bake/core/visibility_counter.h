#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bake/core/patch.h"
#include "common/cache/cache_items.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// Cells of the direction mesh as plane triangles, whose points are the directions of rays. What
/// drawing one reads fits the caches near the processor, which a table of directions would not.
class DirectionTable {
public:
    static constexpr std::uint32_t kCells = 8;

    /// Eight consecutive cells: corner, and sides from there.
    struct alignas(32) Octet {
        float corner[3][kCells], side1[3][kCells], side2[3][kCells];
    };

    /// Points spread evenly over a triangle, near ones side by side, as shares of both sides.
    static constexpr std::uint32_t kPoints = 256;
    struct Point {
        float along1, along2;
    };

    DirectionTable();

    /// Cells 8i .. 8i + 7 of `level` (<= kMaxCacheLevel); at level 0 the last four are empty.
    const Octet& octet(int level, std::uint32_t i) const noexcept {
        return octets_[static_cast<std::size_t>(level)][i];
    }
    const Point& point(std::uint32_t i) const noexcept { return points_[i]; }

private:
    std::array<std::vector<Octet>, kMaxCacheLevel + 1> octets_;
    std::array<Point, kPoints> points_;
};

/// Rays counted in one region, both numbers (< 2^16) in one word, so that eight add as one vector.
struct Count {
    static constexpr std::uint32_t kRay = 1, kVisible = 1u << 16;

    std::uint32_t word = 0;

    std::uint32_t rays() const { return word % kVisible; }
    std::uint32_t visible() const { return word / kVisible; }
    bool mixed() const { return visible() > 0 && visible() < rays(); }
    Count& operator+=(const Count& more) {
        word += more.word;
        return *this;
    }
};

/// Ordered pairs of rays into different cells that start at one point.
struct OriginPairs {
    std::uint32_t counted = 0;  ///< rays of the pairs are both counted
    std::uint32_t visible = 0;  ///< and both reach the sky

    OriginPairs& operator+=(const OriginPairs& more) {
        counted += more.counted;
        visible += more.visible;
        return *this;
    }
};

/// Traces rays that start on one patch in streams and counts them by region.
class VisibilityCounter {
public:
    /// Keeps references to its arguments. `seed` decides the rays' directions and origins.
    VisibilityCounter(const Scene& scene, const DirectionTable& directions, const Patch& patch,
                      std::uint64_t seed);

    /// Queues `count` rays into each of the cells 8 octet + k of `level` for which bit k of `cells`
    /// is set: `count` shots of rays, one into each cell, from one point each. Those into a cell
    /// are tallied in tallies[k] once flush() returns, and the pairs in each shot in `pairs` unless
    /// it is null. Rays below the horizon of the point they start from are left out.
    void add(int level, std::uint32_t octet, std::uint32_t cells, int count, Count* tallies,
             OriginPairs* pairs = nullptr);

    /// Traces what is queued.
    void flush();

    std::uint64_t raysTraced() const { return traced_; }

private:
    static constexpr std::uint32_t kCells = DirectionTable::kCells;

    /// Where the rays of one octet stand in the stream.
    struct Queued {
        Count* tallies;
        OriginPairs* pairs;  ///< may be null
        std::uint32_t first;
        std::uint32_t cells;
    };

    void addOne(const DirectionTable::Octet& octet, std::uint32_t cells, std::uint32_t firstPoint,
                std::uint32_t points, Count* tallies, OriginPairs* pairs);

    void append(const float (&direction)[3][kCells], const Vec3f& origin);

    const Scene& scene_;
    const DirectionTable& directions_;
    const Patch& patch_;
    std::uint64_t state_;
    std::uint64_t traced_ = 0;
    RayStream stream_;
    std::uint32_t rays_ = 0;  ///< in the stream
    std::array<Queued, RayStream::kSize> queue_;
    std::size_t queued_ = 0;
};

}  // namespace shadowcache
