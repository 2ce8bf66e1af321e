#include "bake/inspect/item_regions.h"

#include "common/predict/posterior.h"

namespace shadowcache {

void ItemRegions::use(const CacheItems& items, std::size_t i) {
    const std::size_t cells = tiers_.baseCells();
    const std::uint32_t begin = items.firstBlock[i], end = items.firstBlock[i + 1];
    keys_.clear();
    for (std::uint32_t b = begin; b < end; ++b)
        keys_.push_back(static_cast<std::int16_t>(items.blocks[b].key));
    const CountBlock* blocks = items.blocks.data() + begin;
    use({items.n.data() + i * cells, items.d.data() + i * cells, keys_.data(),
         end > begin ? blocks->n.data() : nullptr, end > begin ? blocks->d.data() : nullptr,
         sizeof(CountBlock), sizeof(CountBlock), end - begin, items.normal[i], 1.0f, i});
}

double ItemRegions::prior() const {
    double visible = 0, counted = 0;
    for (std::uint32_t b = 0; b < tiers_.baseBlocks(); ++b) {
        const BlockCounts counts = counts_->base(b);
        for (int i = 0; i < kBlockCells; ++i) {
            if (counts.d[i] == 0) continue;
            visible += static_cast<double>(counts.n[i]) / counts.d[i];
            ++counted;
        }
    }
    return spherePrior(visible, counted);
}

CountedRegion ItemRegions::region(int tier, std::uint32_t cell, const BlockCounts& counts,
                                  double prior) const {
    const std::uint8_t n = counts.n[cell % kBlockCells], d = counts.d[cell % kBlockCells];
    return {tiers_.levelOf(tier), cell, n, d, posteriorVisibility<double>(n, d, prior)};
}

const std::vector<CountedRegion>& ItemRegions::finest() {
    finest_.clear();
    walk(*counts_, prior(),
         [&](int tier, std::uint32_t block, const auto& counts, double above, const auto& descend) {
             for (int i = 0; i < kBlockCells; ++i) {
                 const std::uint32_t cell = block * kBlockCells + static_cast<std::uint32_t>(i);
                 if (cell >= cellCount(tiers_.levelOf(tier))) return;
                 const CountedRegion r = region(tier, cell, *counts, above);
                 if (counts_->hasChildren(tier, cell))
                     descend(i, r.posterior);
                 else if (r.d > 0)
                     finest_.push_back(r);
             }
         });
    return finest_;
}

CountedRegion ItemRegions::along(std::uint32_t finestCell) const {
    CountedRegion found{0, 0, 0, 0, prior()};
    descend(*counts_, kMaxCacheLevel, finestCell,
            [&](int tier, const BlockCounts& counts, int, int) {
                const std::uint32_t cell =
                    ancestorCell(finestCell, kMaxCacheLevel, tiers_.levelOf(tier));
                found = region(tier, cell, counts, found.posterior);
            });
    return found;
}

}  // namespace shadowcache
