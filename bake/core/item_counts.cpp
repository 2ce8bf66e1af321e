#include "bake/core/item_counts.h"

namespace shadowcache {

void store(const ItemCounts& counts, const Patch& patch, const Vec3i& voxel, CacheItems& out) {
    out.voxel.push_back(voxel);
    out.patch.push_back(patch.code.packed());
    out.normal.push_back(patch.normal);
    out.position.push_back(patch.meanPosition);
    for (const Count& count : counts.base) {
        out.n.push_back(0);
        out.d.push_back(0);
        addCounts(out.n.back(), out.d.back(), count.visible(), count.rays());
    }
    for (const ItemCounts::Block& from : counts.blocks) {
        CountBlock block{from.key, {}, {}};
        for (std::size_t k = 0; k < kBlockCells; ++k)
            addCounts(block.n[k], block.d[k], from.cells[k].visible(), from.cells[k].rays());
        out.blocks.push_back(block);
    }
    out.firstBlock.push_back(static_cast<std::uint32_t>(out.blocks.size()));
}

}  // namespace shadowcache
