#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "common/cache/cache_items.h"

namespace shadowcache {

/// Regions with rays, and those of them in which all rays agreed.
struct RegionTally {
    std::uint64_t counted = 0;  ///< regions with rays
    std::uint64_t pure = 0;     ///< regions in which all rays agreed

    /// Counts a region with these counts, n <= d.
    void add(unsigned n, unsigned d) {
        counted += d > 0;
        pure += d > 0 && (n == 0 || n == d);
    }
    /// Share of the regions with rays, 0 if there are none.
    double pureShare() const {
        return counted ? static_cast<double>(pure) / static_cast<double>(counted) : 0.0;
    }
};

/// Figures of a cache's contents.
struct CacheSummary {
    static constexpr std::size_t kBins = 10;  ///< of histograms of shares

    Vec3d low{0, 0, 0}, high{0, 0, 0};  ///< box of the voxels, world space
    std::uint64_t voxels = 0;           ///< with items
    std::uint64_t subpatches = 0;       ///< items that are subpatches
    RegionTally base, finer;            ///< coarsest regions; those of blocks
    /// Items by their sky visibility, the mean visible share of their base cells.
    std::array<std::uint64_t, kBins> skyVisibility{};
    /// Regions by their rays: none, 1, 2 to 3, 4 to 7, ... 128 to 255.
    std::array<std::uint64_t, 9> rays{};
    /// Regions with rays by the visible share: none, tenths between, all.
    std::array<std::uint64_t, kBins + 2> shares{};
    std::uint64_t emitterRays = 0;                             ///< to emitters, as items keep them
    std::vector<std::pair<std::string, std::uint64_t>> bytes;  ///< by attribute, uncompressed
};

/// Sums up a whole cache.
CacheSummary summarize(const CacheHeader& header, const CacheItems& items);

}  // namespace shadowcache
