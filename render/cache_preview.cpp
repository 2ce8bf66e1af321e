#include "render/cache_preview.h"

#include <algorithm>
#include <array>

#include "render/lanes.h"

namespace shadowcache {

namespace {

/// A cell may be unsure of this much of the place's own light before it is split. In bright places
/// that is more than what samples need.
constexpr float kLeastShare = 2.5e-3f;

/// Blocks of base cells: twenty cells of level 0, or eighty of level 1.
constexpr std::size_t kMostBaseBlocks = 5;

/// Visibility of each of sixteen cells; `above` where there are no counts.
/// @return whether anything is open
bool findVisibility(const PooledBlock* counts, float above, float* c) {
    if (!counts) {
        std::fill_n(c, kBlockCells, above);
        return above > 0;
    }
    for (int i = 0; i < kBlockCells; ++i) c[i] = counts->ratioOrNone(i);
    return maximumOf(c) > 0;
}

}  // namespace

struct CachePreview::Sum {
    const PooledVisibility& pooled;
    Vec3f normal;
    float leastNoise;
    alignas(64) float lanes[3][kBlockCells] = {};
};

CachePreview::CachePreview(const Environment& environment, const DirectionTiers& tiers)
    : environment_(environment), tiers_(tiers), splitter_(environment, tiers) {}

Rgb CachePreview::irradiance(const PooledVisibility& pooled, const Vec3f& normal) const {
    struct Base {
        CellLight sky;
        alignas(64) float c[kBlockCells];
        bool open;
    };
    std::array<Base, kMostBaseBlocks> bases;
    float bright = 0;
    for (std::uint32_t b = 0; b < pooled.baseBlocks(); ++b) {
        Base& base = bases[b];
        base.open = findVisibility(&pooled.base(b), 0, base.c);
        if (!base.open) continue;
        lightCells(environment_.cells(tiers_.baseLevel(), b), normal,
                   environment_.luminanceWeights(), base.sky);
        alignas(64) float light[kBlockCells];
        for (int i = 0; i < kBlockCells; ++i) light[i] = base.c[i] * base.sky.light[i];
        bright += sumOf(light);
    }
    Sum sum{pooled, normal, std::max(splitter_.leastNoise(), kLeastShare * bright)};
    for (std::uint32_t b = 0; b < pooled.baseBlocks(); ++b)
        if (bases[b].open) addSplit(0, b, bases[b].sky, bases[b].c, sum);
    return {sumOf(sum.lanes[0]), sumOf(sum.lanes[1]), sumOf(sum.lanes[2])};
}

void CachePreview::addBlock(int tier, std::uint32_t block, const PooledBlock* counts, float above,
                            Sum& sum) const {
    alignas(64) float c[kBlockCells];
    if (!findVisibility(counts, above, c)) return;
    CellLight sky;
    lightCells(environment_.cells(tiers_.baseLevel() + 2 * tier, block), sum.normal,
               environment_.luminanceWeights(), sky);
    addSplit(tier, block, sky, c, sum);
}

/// Adds the cells of a block that stay whole, and the children of the others.
void CachePreview::addSplit(int tier, std::uint32_t block, const CellLight& sky, const float* c,
                            Sum& sum) const {
    Splits split;
    splitter_.mark(sum.pooled, tier, block, sky, c, sum.leastNoise, split);
    for (int i = 0; i < kBlockCells; ++i) {
        const float share = split.any && split.marks[i] ? 0.0f : c[i];
        for (int k = 0; k < 3; ++k) sum.lanes[k][i] += share * sky.flux[k][i];
    }
    split.forEach([&](int i) {
        const std::uint32_t cell = block * kBlockCells + static_cast<std::uint32_t>(i);
        addBlock(tier + 1, cell, sum.pooled.children(tier, cell), c[i], sum);
    });
}

}  // namespace shadowcache
