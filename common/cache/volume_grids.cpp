#include "common/cache/volume_grids.h"

namespace shadowcache {

namespace {

/// Calls `add(voxel, cell, n / d, weight)` for every counted base region of every item; parts of
/// patches weigh what they are of the whole.
template <class Add>
void forBaseRegions(const CacheHeader& header, const CacheItems& items, const VoxelRuns& runs,
                    const Add& add) {
    const std::size_t cells = header.tiers().baseCells();
    for (std::size_t v = 0; v < runs.voxels.size(); ++v)
        for (std::size_t i = runs.firstItem[v]; i < runs.firstItem[v + 1]; ++i) {
            const float weight = shareOf(PatchCode::of(items.patch[i]).subpatch);
            for (std::size_t c = 0; c < cells; ++c) {
                const unsigned d = items.d[i * cells + c];
                if (d > 0)
                    add(v, c, static_cast<float>(items.n[i * cells + c]) / static_cast<float>(d),
                        weight);
            }
        }
}

}  // namespace

VoxelRuns findVoxels(const CacheItems& items) {
    VoxelRuns runs;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i > 0 && items.voxel[i] == items.voxel[i - 1]) continue;
        runs.voxels.push_back(items.voxel[i]);
        runs.firstItem.push_back(i);
    }
    runs.firstItem.push_back(items.size());
    return runs;
}

VolumeGrid skyVisibilityGrid(const CacheHeader& header, const CacheItems& items,
                             const VoxelRuns& runs) {
    std::vector<double> visible(runs.voxels.size()), counted(runs.voxels.size());
    forBaseRegions(header, items, runs, [&](std::size_t v, std::size_t, float share, float weight) {
        visible[v] += static_cast<double>(share * weight);
        counted[v] += static_cast<double>(weight);
    });
    VolumeGrid grid{kSkyVisibilityGrid, VolumeKind::fog, {}};
    for (std::size_t v = 0; v < visible.size(); ++v)
        grid.values.emplace_back(counted[v] > 0 ? static_cast<float>(visible[v] / counted[v])
                                                : 0.0f);
    return grid;
}

VolumeGrid bentNormalGrid(const CacheHeader& header, const CacheItems& items,
                          const VoxelRuns& runs) {
    const DirectionTiers tiers = header.tiers();
    std::vector<Vec3f> centers;
    for (std::uint32_t c = 0; c < tiers.baseCells(); ++c)
        centers.emplace_back(cellCenter(tiers.baseLevel(), c));
    VolumeGrid grid{kBentNormalGrid, VolumeKind::direction,
                    std::vector<Vec3f>(runs.voxels.size(), Vec3f(0))};
    std::vector<float> counted(runs.voxels.size());
    forBaseRegions(header, items, runs,
                   [&](std::size_t v, std::size_t c, float share, float weight) {
                       grid.values[v] += centers[c] * (share * weight);
                       counted[v] += weight;
                   });
    for (std::size_t v = 0; v < counted.size(); ++v)
        if (counted[v] > 0) grid.values[v] /= counted[v];
    return grid;
}

}  // namespace shadowcache
