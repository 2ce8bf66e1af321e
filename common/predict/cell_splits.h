#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "common/predict/cell_light.h"

namespace shadowcache {

/// Which of sixteen cells are to be split.
struct Splits {
    alignas(16) std::uint8_t marks[kBlockCells];  ///< 1: split, else 0; undefined unless any
    bool any = false;                             ///< whether any is to be split

    /// Calls `visit` with the number (0 .. 15) of each cell that is to be split, in their order.
    template <class Visit>
    void forEach(const Visit& visit) const {
        if (!any) return;
        std::uint64_t halves[2];
        std::memcpy(halves, marks, sizeof halves);
        for (int half = 0; half < 2; ++half)
            for (std::uint64_t left = halves[half]; left; left &= left - 1)
                visit(8 * half + std::countr_zero(left) / 8);
    }
};

/// Decides where the hemisphere above a place is split into finer regions. Immutable, thread-safe.
class CellSplitter {
public:
    /// @param tiers  of the cache: header().tiers()
    CellSplitter(const Environment& environment, const DirectionTiers& tiers);

    /// Noise below which a cell stays whole: a share of the luminance integral of the sky
    /// [radiance sr].
    float leastNoise() const { return leastNoise_; }

    /// Marks the cells of block `block` of a tier that as a whole would add more noise than
    /// `leastNoise`: those that are partly occluded and have finer counts, and those that the
    /// horizon cuts. Cells at the finest level of the environment's table stay whole.
    ///
    /// @param counts  has hasChildren(tier, cell): a CountTree
    /// @param sky     light of the sixteen cells
    /// @param c       their visible shares, in [0, 1]
    /// @param leastNoise  above 0 [radiance sr]
    template <class Counts>
    void mark(const Counts& counts, int tier, std::uint32_t block, const CellLight& sky,
              const float* c, float leastNoise, Splits& out) const {
        alignas(16) std::uint8_t uncertain[kBlockCells];
        if (!decide(tier, sky, c, leastNoise, uncertain, out)) return;
        for (std::uint32_t i = 0; i < kBlockCells; ++i)
            if (uncertain[i] != 0)
                out.marks[i] |=
                    static_cast<std::uint8_t>(counts.hasChildren(tier, block * kBlockCells + i));
        out.any = std::any_of(out.marks, out.marks + kBlockCells,
                              [](std::uint8_t mark) { return mark != 0; });
    }

private:
    /// Marks the cells for which the horizon is reason enough, and notes those whose visibility is
    /// uncertain.
    /// @return whether any cell can be split
    bool decide(int tier, const CellLight& sky, const float* c, float leastNoise,
                std::uint8_t* uncertain, Splits& out) const;

    DirectionTiers tiers_;
    int finest_;  ///< level down to which cells on the horizon are split
    float leastNoise_;
};

}  // namespace shadowcache
