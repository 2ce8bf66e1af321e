#include "bake/inspect/item_regions.h"

namespace shadowcache {

namespace {

/// Mean of what the counts leave possible; the prior weighs as much as half a ray.
double posterior(unsigned n, unsigned d, double prior) {
    constexpr double kPriorRays = 0.5;
    return (n + kPriorRays * prior) / (d + kPriorRays);
}

}  // namespace

void ItemRegions::use(const CacheItems& items, std::size_t i) {
    const std::size_t cells = tiers_.baseCells();
    const std::uint32_t begin = items.firstBlock[i], end = items.firstBlock[i + 1];
    keys_.clear();
    blockN_.clear();
    blockD_.clear();
    for (std::uint32_t b = begin; b < end; ++b) {
        const CountBlock& block = items.blocks[b];
        keys_.push_back(static_cast<std::int16_t>(block.key));
        blockN_.insert(blockN_.end(), block.n.begin(), block.n.end());
        blockD_.insert(blockD_.end(), block.d.begin(), block.d.end());
    }
    item_ = {items.n.data() + i * cells,
             items.d.data() + i * cells,
             keys_.data(),
             blockN_.data(),
             blockD_.data(),
             kBlockCells,
             kBlockCells,
             end - begin,
             items.normal[i],
             1.0f,
             i};
}

const std::uint8_t* ItemRegions::block(int tier, std::uint32_t parent,
                                       const std::uint8_t*& d) const {
    if (tier >= tiers_.refinements()) return nullptr;
    const int found = item_.findBlock(tiers_.blockKey(tier, parent));
    if (found < 0) return nullptr;
    const BlockCounts counts = item_.block(static_cast<std::size_t>(found));
    d = counts.d;
    return counts.n;
}

void ItemRegions::addCell(int tier, const CountedRegion& cell) {
    const std::uint8_t* d = nullptr;
    const std::uint8_t* n = block(tier, cell.cell, d);
    if (!n) {
        if (cell.d > 0) finest_.push_back(cell);
        return;
    }
    for (std::uint32_t k = 0; k < kBlockCells; ++k)
        addCell(tier + 1, {levelOf(tier + 1), cell.cell * kBlockCells + k, n[k], d[k],
                           posterior(n[k], d[k], cell.posterior)});
}

double ItemRegions::prior() const {
    unsigned n = 0, d = 0;
    for (std::uint32_t cell = 0; cell < tiers_.baseCells(); ++cell) {
        n += item_.n[cell];
        d += item_.d[cell];
    }
    return posterior(n, d, 0.5);
}

const std::vector<CountedRegion>& ItemRegions::finest() {
    finest_.clear();
    const double all = prior();
    for (std::uint32_t cell = 0; cell < tiers_.baseCells(); ++cell) {
        const unsigned n = item_.n[cell], d = item_.d[cell];
        addCell(0, {levelOf(0), cell, n, d, posterior(n, d, all)});
    }
    return finest_;
}

CountedRegion ItemRegions::along(std::uint32_t finestCell) const {
    const auto at = [&](int tier) {
        return ancestorCell(finestCell, kMaxCacheLevel, levelOf(tier));
    };
    std::uint32_t cell = at(0);
    const auto made = [](int level, std::uint32_t c, unsigned n, unsigned d, double above) {
        return CountedRegion{level, c, n, d, posterior(n, d, above)};
    };
    CountedRegion region = made(levelOf(0), cell, item_.n[cell], item_.d[cell], prior());
    for (int tier = 0; tier < tiers_.refinements(); ++tier) {
        const std::uint8_t* d = nullptr;
        const std::uint8_t* n = block(tier, cell, d);
        if (!n) break;
        cell = at(tier + 1);
        region = made(levelOf(tier + 1), cell, n[cell % kBlockCells], d[cell % kBlockCells],
                      region.posterior);
    }
    return region;
}

}  // namespace shadowcache
