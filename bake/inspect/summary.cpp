#include "bake/inspect/summary.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "common/cache/emitter_code.h"

namespace shadowcache {

namespace {

/// Mean visible share of an item's regions; as the grid for volume tools has it, but by item.
double visibleShare(const CacheItems& items, std::size_t item, std::size_t cells) {
    double visible = 0;
    unsigned counted = 0;
    for (std::size_t c = item * cells; c < (item + 1) * cells; ++c) {
        if (items.d[c] == 0) continue;
        visible += static_cast<double>(items.n[c]) / items.d[c];
        ++counted;
    }
    return counted ? visible / counted : 0.0;
}

void findBounds(const CacheHeader& header, const CacheItems& items, CacheSummary& summary) {
    if (items.size() == 0) return;
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    summary.low = Vec3d(kInfinity);
    summary.high = Vec3d(-kInfinity);
    for (const Vec3i& voxel : items.voxel)
        for (int k = 0; k < 3; ++k) {
            summary.low[k] = std::min(summary.low[k], (voxel[k] - 0.5) * header.spacing);
            summary.high[k] = std::max(summary.high[k], (voxel[k] + 0.5) * header.spacing);
        }
}

std::size_t shareBin(unsigned n, unsigned d) {
    if (n == 0) return 0;
    return n == d ? CacheSummary::kBins + 1 : 1 + n * CacheSummary::kBins / d;
}

template <class T>
std::uint64_t bytesOf(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

}  // namespace

CacheSummary summarize(const CacheHeader& header, const CacheItems& items) {
    CacheSummary summary;
    const std::size_t cells = header.tiers().baseCells();
    findBounds(header, items, summary);
    for (std::size_t i = 0; i < items.size(); ++i) {
        summary.voxels += i == 0 || items.voxel[i] != items.voxel[i - 1];
        summary.subpatches += PatchCode::of(items.patch[i]).subpatch != 0;
        const double visible = visibleShare(items, i, cells);
        ++summary.skyVisibility[std::min(static_cast<std::size_t>(visible * CacheSummary::kBins),
                                         CacheSummary::kBins - 1)];
    }
    const auto add = [&](RegionTally& tally, unsigned n, unsigned d) {
        tally.add(n, d);
        ++summary.rays[static_cast<std::size_t>(std::bit_width(d))];
        if (d > 0) ++summary.shares[shareBin(n, d)];
    };
    for (std::size_t c = 0; c < items.d.size(); ++c) add(summary.base, items.n[c], items.d[c]);
    for (const CountBlock& block : items.blocks)
        for (std::size_t c = 0; c < block.d.size(); ++c) add(summary.finer, block.n[c], block.d[c]);
    for (const std::uint16_t code : items.emitters)
        summary.emitterRays += static_cast<std::uint64_t>(EmitterCode::rays(code));

    const std::uint64_t blockBytes = items.blocks.size() * std::uint64_t{kBlockCells};
    summary.bytes = {{"items.position", bytesOf(items.position)},
                     {"items.normal", bytesOf(items.normal)},
                     {"items.patch", bytesOf(items.patch)},
                     {"items.n", bytesOf(items.n)},
                     {"items.d", bytesOf(items.d)},
                     {"items.first_block", items.size() * sizeof(std::int32_t)},
                     {"items.block_count", items.size() * sizeof(std::int16_t)},
                     {"items.hits", bytesOf(items.hits)},
                     {"items.emitters", bytesOf(items.emitters)},
                     {"blocks.key", items.blocks.size() * sizeof(std::int16_t)},
                     {"blocks.n", blockBytes},
                     {"blocks.d", blockBytes}};
    return summary;
}

}  // namespace shadowcache
