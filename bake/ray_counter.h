#pragma once

#include <cstdint>
#include <vector>

#include "bake/patch.h"
#include "common/direction_mesh.h"
#include "common/scene.h"

namespace shadowcache {

/// Directions spread over the cells of the direction mesh, ready made: drawing one is a table
/// look-up.
class DirectionTable {
public:
    static constexpr int kLevel = 7;

    DirectionTable();

    /// Direction in cell `cell` of `level` (<= kLevel): stratum `i` of `count` of its descendants,
    /// `random` decides which.
    const Vec3f& direction(int level, std::uint32_t cell, int i, int count,
                           std::uint32_t random) const noexcept {
        const std::uint32_t size = 1u << (2 * (kLevel - level));
        const auto below =
            static_cast<std::uint32_t>((static_cast<std::uint64_t>(i) * size +
                                        (static_cast<std::uint64_t>(random) * size >> 32)) /
                                       static_cast<std::uint64_t>(count));
        return centers_[(cell << (2 * (kLevel - level))) + below];
    }

private:
    std::vector<Vec3f> centers_;
};

/// Rays counted in one region.
struct Count {
    std::uint16_t open = 0;
    std::uint16_t rays = 0;

    bool mixed() const { return open > 0 && open < rays; }
    Count& operator+=(const Count& more) {
        open = static_cast<std::uint16_t>(open + more.open);
        rays = static_cast<std::uint16_t>(rays + more.rays);
        return *this;
    }
};

/// Traces the rays of one patch in packets and counts them by region.
class RayCounter {
public:
    RayCounter(const Scene& scene, const DirectionTable& directions, const Patch& patch,
               std::uint64_t seed);

    /// Queues `count` rays into cell `cell` of `level`, tallied in `tally` once flush() returns.
    /// Rays below the horizon of the point they start from are left out.
    void add(int level, std::uint32_t cell, int count, Count& tally);

    /// Traces what is queued.
    void flush();

    /// Traces up to eight rays into a cell now and returns the least distance to an occluder,
    /// infinite if none was met.
    float nearestOccluder(int level, std::uint32_t cell, Count& tally);

    std::uint64_t raysTraced() const { return traced_; }

private:
    RayPacket packet_{};
    const Scene& scene_;
    const DirectionTable& directions_;
    const Patch& patch_;
    std::uint64_t state_;
    std::uint64_t traced_ = 0;
    Count* tallies_[RayPacket::kSize] = {};
    int queued_ = 0;

    bool place(int level, std::uint32_t cell, int i, int count);
};

}  // namespace shadowcache
