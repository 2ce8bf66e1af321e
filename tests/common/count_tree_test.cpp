// Trees of counts: an item's own and the pooled one are alike, and the walks meet every region.

#include "common/predict/count_tree.h"

#include <gtest/gtest.h>

#include <map>
#include <optional>

#include "common/predict/cached_visibility.h"
#include "common/predict/posterior.h"
#include "tests/support/counted_item.h"

namespace shadowcache {
namespace {

using test::CountedItem;

/// Counts that differ from cell to cell; every third base cell has finer ones, as has every fifth
/// cell of these.
CountedItem someItem(const DirectionTiers& tiers) {
    CountedItem item(tiers);
    for (std::uint32_t cell = 0; cell < tiers.baseCells(); ++cell) {
        item.base(cell, cell % 5, 4 + cell % 3);
        if (tiers.refinements() == 0 || cell % 3 != 0) continue;
        for (std::size_t i = 0; i < kBlockCells; ++i) item.child(0, cell, i, i % 4, 3 + i % 2);
        const std::uint32_t child = cell * kBlockCells + cell % 5;
        if (tiers.refinements() == 2)
            for (std::size_t i = 0; i < kBlockCells; ++i) item.child(1, child, i, i % 2, 1);
    }
    return item;
}

class CountTrees : public testing::TestWithParam<int> {
protected:
    const DirectionTiers tiers_{GetParam()};
    CountedItem item_ = someItem(tiers_);
    const ItemView view_ = item_.view(1);
    const ItemCountTree counts_{view_, tiers_};
    PooledVisibility pooled_{tiers_};

    CountTrees() { pooled_.pool({&view_, 1}); }
};

void expectAlike(const BlockCounts& counts, const PooledBlock& pooled) {
    for (int i = 0; i < kBlockCells; ++i) {
        EXPECT_EQ(static_cast<float>(counts.d[i]), pooled.rays[i]);
        if (counts.d[i] == 0) continue;
        EXPECT_FLOAT_EQ(static_cast<float>(counts.n[i]) / static_cast<float>(counts.d[i]),
                        pooled.ratio(i));
    }
}

TEST_P(CountTrees, OfOneItemAreAlike) {
    int blocks = 0;
    for (std::uint32_t b = 0; b < tiers_.baseBlocks(); ++b)
        expectAlike(counts_.base(b), pooled_.base(b));
    for (int tier = 0; tier < 3; ++tier)
        for (std::uint32_t cell = 0; tier < 2 && cell < cellCount(tiers_.levelOf(tier)); ++cell) {
            const std::optional<BlockCounts> one = counts_.children(tier, cell);
            EXPECT_EQ(counts_.hasChildren(tier, cell), one.has_value());
            const PooledBlock* two = pooled_.children(tier, cell);
            ASSERT_EQ(one.has_value(), two != nullptr) << tier << " " << cell;
            if (!one) continue;
            ++blocks;
            expectAlike(*one, *two);
        }
    EXPECT_EQ(blocks, static_cast<int>(view_.blockCount));
}

TEST_P(CountTrees, AreWalkedWithoutGapsAndOverlaps) {
    double sphere = 0;
    std::uint64_t rays = 0;
    walk(counts_, tiers_.baseLevel(),
         [&](int tier, std::uint32_t block, const auto& counts, int level, const auto& descend) {
             EXPECT_EQ(level, tiers_.levelOf(tier)) << "as the parent handed down";
             for (int i = 0; i < kBlockCells; ++i) {
                 const std::uint32_t cell = block * kBlockCells + static_cast<std::uint32_t>(i);
                 if (cell >= cellCount(level)) continue;
                 if (counts_.hasChildren(tier, cell)) {
                     descend(i, level + 2);
                     continue;
                 }
                 ASSERT_TRUE(static_cast<bool>(counts));
                 rays += counts->d[i];
                 sphere += 1.0 / cellCount(level);
             }
         });
    EXPECT_NEAR(sphere, 1, 1e-12);
    std::uint64_t expected = 0;
    for (std::uint32_t cell = 0; cell < tiers_.baseCells(); ++cell)
        if (!counts_.hasChildren(0, cell)) expected += view_.d[cell];
    for (std::uint32_t k = 0; k < view_.blockCount; ++k)
        for (std::size_t i = 0; i < kBlockCells; ++i) expected += view_.block(k).d[i];
    for (std::uint32_t cell = 0; cell < cellCount(tiers_.levelOf(1)); ++cell)
        if (counts_.hasChildren(1, cell)) expected -= counts_.children(0, cell / 16)->d[cell % 16];
    EXPECT_EQ(rays, expected);
}

TEST_P(CountTrees, AreDescendedToTheFinestCounts) {
    for (std::uint32_t cell = 0; cell < cellCount(kMaxCacheLevel); cell += 7) {
        int tier = 0;
        std::uint32_t at = ancestorCell(cell, kMaxCacheLevel, tiers_.baseLevel());
        unsigned d = view_.d[at];
        while (const auto children = counts_.children(tier, at)) {
            at = ancestorCell(cell, kMaxCacheLevel, tiers_.levelOf(++tier));
            d = children->d[at % kBlockCells];
        }
        int lastTier = -1;
        unsigned found = 0;
        descend(counts_, kMaxCacheLevel, cell,
                [&](int t, const BlockCounts& counts, int first, int count) {
                    EXPECT_EQ(t, lastTier + 1);
                    EXPECT_EQ(count, 1);
                    lastTier = t;
                    found = counts.d[first];
                });
        EXPECT_EQ(lastTier, tier);
        EXPECT_EQ(found, d);
        EXPECT_EQ(visibilityOf(pooled_, kMaxCacheLevel, cell).rays, static_cast<float>(d));
    }
}

INSTANTIATE_TEST_SUITE_P(Levels, CountTrees, testing::Range(0, kMaxCacheLevel + 1));

TEST(CachedVisibility, IsTheMeanOfTheCellsInACoarserOne) {
    const DirectionTiers tiers{5};
    CountedItem item(tiers);
    item.base(4, 1, 4).base(5, 4, 4).base(7, 1, 2);  // children 0, 1 and 3 of cell 1 of level 0
    item.child(0, 4, 8, 0, 2).child(0, 4, 9, 2, 2).child(0, 4, 10, 1, 2);
    const ItemView view = item.view(1);
    PooledVisibility pooled(tiers);
    pooled.pool({&view, 1});

    const CachedVisibility coarse = visibilityOf(pooled, 0, 1);
    EXPECT_FLOAT_EQ(coarse.ratio, (0.25f + 1 + 0.5f) / 3);
    EXPECT_FLOAT_EQ(coarse.rays, 10);
    EXPECT_FLOAT_EQ(visibilityOf(pooled, 1, 4).ratio, 0.25f);
    // Level 2 lies between the base and its children: cell 4 * 4 + 2 holds children 8 .. 11.
    EXPECT_FLOAT_EQ(visibilityOf(pooled, 2, 4 * 4 + 2).ratio, 0.5f);
    EXPECT_FLOAT_EQ(visibilityOf(pooled, 2, 4 * 4 + 2).rays, 6);
    EXPECT_FLOAT_EQ(visibilityOf(pooled, 3, 4 * 16 + 9).ratio, 1);
    // Finer cells are what the one that holds them is.
    EXPECT_FLOAT_EQ(visibilityOf(pooled, 5, (4 * 16 + 8) * 16 + 3).ratio, 0);
    EXPECT_FLOAT_EQ(visibilityAlong(pooled, cellCenter(3, 4 * 16 + 8)).ratio, 0);
    // Nothing was counted: all is visible, and nothing is known.
    EXPECT_EQ(visibilityOf(pooled, 1, 40).ratio, 1);
    EXPECT_EQ(visibilityOf(pooled, 1, 40).rays, 0);
}

TEST(Posterior, WeighsTheParentAsHalfARay) {
    EXPECT_DOUBLE_EQ(posteriorVisibility(0.0, 0.0, 0.3), 0.3);
    EXPECT_DOUBLE_EQ(posteriorVisibility(2.0, 2.0, 0.5), 2.25 / 2.5);
    EXPECT_FLOAT_EQ(posteriorVisibility(0.0f, 2.0f, 0.5f), 0.1f);
    EXPECT_DOUBLE_EQ(spherePrior(0.0, 0.0), 0.5);
    EXPECT_DOUBLE_EQ(spherePrior(3.0, 3.0), 3.5 / 4);
}

}  // namespace
}  // namespace shadowcache
