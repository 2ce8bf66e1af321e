#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/light/environment.h"
#include "render/regions/region_shares.h"

namespace shadowcache {

/// A region: a group of Regions::groups, and its lane there.
struct RegionPlace {
    static constexpr std::uint32_t kNone = 0xffffffff;

    std::uint32_t group = kNone;
    int lane = 0;

    bool found() const { return group != kNone; }
};

/// How samples are drawn by their shares: a region in proportion to its weight, in the region a
/// direction in proportion to the luminance. [docs/estimator.md]
class RegionDistribution {
public:
    explicit RegionDistribution(const Environment& environment);

    /// Becomes the distribution of these shares. Memory is used again.
    const RegionDistribution& assign(const Regions& regions, const RegionShares& shares);

    /// Whether nothing can be drawn: pdf() is 0 everywhere.
    bool empty() const { return !(weightSum_ > 0); }

    /// Direction for a number `u` in [0, 1), and its pdf() as EnvironmentSample::density; not if
    /// empty().
    ///
    /// @param jitterX, jitterY  place in the texel, in [0, 1)
    EnvironmentSample sample(double u, float jitterX, float jitterY) const;
    /// Density of sample() along a unit vector [1/sr].
    double pdf(const Vec3f& direction) const;

    /// Chance of a region.
    double chance(const RegionPlace& place) const {
        return static_cast<double>(groupAt(place).weight[place.lane]) / weightSum_;
    }
    /// Integral of the luminance over a region [radiance sr].
    double light(const RegionPlace& place) const {
        const Group& group = groupAt(place);
        return environment_->luminanceIntegral(
            group.level, group.firstCell + static_cast<std::uint32_t>(place.lane));
    }
    /// The region that holds the light of a cell of Environment::kLevel.
    RegionPlace find(std::uint32_t cell) const;
    /// Density of sample() in a region [1/sr].
    ///
    /// @param place         may be none
    /// @param lightDensity  density in proportion to the light, along the direction [radiance]
    double pdf(const RegionPlace& place, double lightDensity) const;

    /// The choice of a region, and of a place in its light.
    struct Choice {
        RegionPlace place;
        double inverseChance;  ///< of the region
        double u;              ///< in [0, 1): what is left of the number that chose
    };
    /// Chooses regions for ascending numbers, of a distribution that is not empty.
    class Walk {
    public:
        explicit Walk(const RegionDistribution& distribution);
        /// @param u  in [0, 1), no less than the one before
        Choice next(double u);

    private:
        const RegionDistribution& distribution_;
        std::size_t group_ = 0, lastGroup_;
        int lane_ = 0;
        double belowGroup_ = 0;  ///< sum of the weights before the group
        double belowLane_ = 0;   ///< and before its lane
    };

    /// Begins to draw a direction in a region.
    Environment::Draw startDraw(const Choice& choice) const;

private:
    struct alignas(64) Group {
        alignas(64) float weight[kBlockCells];
        double weightSum;
        std::uint32_t firstCell;
        int level;
    };
    const Group& groupAt(const RegionPlace& place) const { return groups_[place.group]; }
    std::size_t slotOf(int level, std::uint32_t cell) const {
        return firstSlot_[static_cast<std::size_t>(level)] + cell / kBlockCells;
    }

    const Environment* environment_;
    std::array<std::uint32_t, Environment::kLevel + 2> firstSlot_{};  ///< by level
    std::vector<std::int16_t> slots_;  ///< group by level and block; -1: none
    int coarsest_ = 0, finest_ = -1;   ///< levels with regions
    std::vector<Group> groups_;        ///< as Regions::groups
    double weightSum_ = 0;
};

}  // namespace shadowcache
