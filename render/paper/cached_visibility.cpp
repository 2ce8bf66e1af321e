#include "render/paper/cached_visibility.h"

namespace shadowcache {

namespace {

CachedVisibility lookUp(const PooledBlock& block, int i) {
    if (block.weight[i] <= 0) return {};
    return {block.ratio(i), block.effectiveRays(i)};
}

/// Mean over `count` cells from i on.
CachedVisibility average(const PooledBlock& block, int i, int count) {
    CachedVisibility sum{0, 0};
    int known = 0;
    for (int k = i; k < i + count; ++k) {
        const CachedVisibility v = lookUp(block, k);
        if (v.rays <= 0) continue;
        sum.ratio += v.ratio;
        sum.rays += v.rays;
        ++known;
    }
    return known ? CachedVisibility{sum.ratio / static_cast<float>(known), sum.rays}
                 : CachedVisibility{};
}

}  // namespace

CachedVisibility visibilityOf(const PooledVisibility& pooled, int level, std::uint32_t cell) {
    const int base = pooled.tiers().baseLevel();
    if (level < base)
        return average(pooled.base(4 * cell / kBlockCells),
                       static_cast<int>(4 * cell % kBlockCells), 4);
    std::uint32_t at = ancestorCell(cell, level, base);
    CachedVisibility found =
        lookUp(pooled.base(at / kBlockCells), static_cast<int>(at % kBlockCells));
    for (int tier = 0; tier < pooled.tiers().refinements(); ++tier) {
        const int finer = base + 2 * (tier + 1);
        const PooledBlock* block = pooled.children(tier, at);
        if (!block || level < finer - 1) break;
        if (level == finer - 1) return average(*block, static_cast<int>(cell % 4) * 4, 4);
        at = ancestorCell(cell, level, finer);
        found = lookUp(*block, static_cast<int>(at % kBlockCells));
    }
    return found;
}

}  // namespace shadowcache
