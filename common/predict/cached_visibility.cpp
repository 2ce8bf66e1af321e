#include "common/predict/cached_visibility.h"

#include "common/predict/count_tree.h"

namespace shadowcache {

namespace {

CachedVisibility visibilityOf(const PooledBlock& block, int i) {
    if (block.weight[i] <= 0) return {};
    return {block.ratio(i), block.effectiveRays(i)};
}

/// Mean over `count` cells from i on.
CachedVisibility average(const PooledBlock& block, int i, int count) {
    CachedVisibility sum{0, 0};
    int known = 0;
    for (int k = i; k < i + count; ++k) {
        const CachedVisibility v = visibilityOf(block, k);
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
    CachedVisibility found;
    descend(pooled, level, cell, [&](int, const PooledBlock& block, int first, int count) {
        found = count == 1 ? visibilityOf(block, first) : average(block, first, count);
    });
    return found;
}

CachedVisibility visibilityAlong(const PooledVisibility& pooled, const Vec3d& direction) {
    return visibilityOf(pooled, kMaxCacheLevel, locateCell(kMaxCacheLevel, direction));
}

}  // namespace shadowcache
