// Counts of several items pooled at a place, by numbers worked out by hand.

#include "common/predict/pooled_visibility.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/counted_item.h"

namespace shadowcache {
namespace {

using test::CountedItem;

constexpr DirectionTiers kTiers{4};  // 20 base cells, their children, and the children of these

void expectCell(const PooledBlock& block, int i, float visible, float weight, float rays,
                float rays2) {
    EXPECT_FLOAT_EQ(block.visible[i], visible) << i;
    EXPECT_FLOAT_EQ(block.weight[i], weight) << i;
    EXPECT_FLOAT_EQ(block.rays[i], rays) << i;
    EXPECT_FLOAT_EQ(block.rays2[i], rays2) << i;
}

/// Items of weights 3/4 and 1/4: a quarter of the one's rays in cell 3 reached the sky, all of the
/// other's; only the one has finer counts there.
class TwoItems : public testing::Test {
protected:
    CountedItem a_{kTiers}, b_{kTiers};
    std::vector<ItemView> items_;
    PooledVisibility pooled_{kTiers};

    TwoItems() {
        a_.base(3, 1, 4).child(0, 3, 0, 0, 2).child(0, 3, 1, 2, 2);
        a_.child(1, 3 * 16 + 0, 0, 1, 2);
        b_.base(3, 2, 2).base(17, 1, 2);
        items_ = {a_.view(0.75f), b_.view(0.25f)};
        pooled_.pool(items_);
    }
};

TEST_F(TwoItems, AddUpInTheBaseCells) {
    const PooledBlock& block = pooled_.base(0);
    expectCell(block, 3, 0.75f * 0.25f + 0.25f, 1, 0.75f * 4 + 0.25f * 2,
               0.5625f * 4 + 0.0625f * 2);
    EXPECT_FLOAT_EQ(block.ratio(3), 0.4375f);
    EXPECT_FLOAT_EQ(block.ratioOrNone(3), 0.4375f);
    EXPECT_FLOAT_EQ(block.effectiveRays(3), 3.5f * 3.5f / 2.375f);
}

TEST_F(TwoItems, CountOnlyWhereTheyHaveRays) {
    // Cell 17 of 20 stands in the second block of sixteen: only the second item has rays there.
    expectCell(pooled_.base(1), 1, 0.125f, 0.25f, 0.5f, 0.125f);
    EXPECT_FLOAT_EQ(pooled_.base(1).ratio(1), 0.5f);
    expectCell(pooled_.base(0), 5, 0, 0, 0, 0);
    EXPECT_EQ(pooled_.base(0).ratioOrNone(5), 0);
    EXPECT_EQ(pooled_.base(0).effectiveRays(5), 0);
    EXPECT_EQ(pooled_.baseBlocks(), 2u);
    for (int i = 4; i < kBlockCells; ++i) expectCell(pooled_.base(1), i, 0, 0, 0, 0);
}

TEST_F(TwoItems, OfWhichOneRefinesACellKeepTheOthersShareOfIt) {
    EXPECT_TRUE(pooled_.hasChildren(0, 3));
    const PooledBlock* children = pooled_.children(0, 3);
    ASSERT_NE(children, nullptr);
    // The second item saw nothing but sky in the parent, so in all its children.
    expectCell(*children, 0, 0.25f, 1, 1.5f, 1.125f);
    expectCell(*children, 1, 1, 1, 1.5f, 1.125f);
    expectCell(*children, 2, 0, 0, 0, 0);
}

TEST_F(TwoItems, HandDownFromTheChildrenToTheirChildren) {
    const PooledBlock* finest = pooled_.children(1, 3 * 16 + 0);
    ASSERT_NE(finest, nullptr);
    // The second item has no counts here: it adds the pooled share of the parent, a quarter.
    expectCell(*finest, 0, 0.75f * 0.5f + 0.25f * 0.25f, 1, 1.5f, 1.125f);
}

TEST_F(TwoItems, HaveNoChildrenWhereNobodyCountedThem) {
    EXPECT_FALSE(pooled_.hasChildren(0, 4));
    EXPECT_EQ(pooled_.children(0, 4), nullptr);
    EXPECT_EQ(pooled_.children(1, 3 * 16 + 1), nullptr);
    EXPECT_EQ(pooled_.children(2, 3 * 16 * 16), nullptr);
}

TEST_F(TwoItems, AreForgottenWhenOthersArePooled) {
    CountedItem c{kTiers};
    c.base(4, 1, 1);
    const ItemView item = c.view(1);
    pooled_.children(0, 3);
    pooled_.addOccluderCone({0, 1, 0}, 3);
    pooled_.pool({&item, 1});
    expectCell(pooled_.base(0), 3, 0, 0, 0, 0);
    expectCell(pooled_.base(0), 4, 1, 1, 1, 1);
    EXPECT_EQ(pooled_.children(0, 3), nullptr);
}

/// An item that sees the sky everywhere but in cell 7.
class OccluderCone : public testing::Test {
protected:
    CountedItem item_{kTiers};
    ItemView view_{};
    PooledVisibility pooled_{kTiers};

    OccluderCone() {
        for (std::uint32_t cell = 0; cell < kTiers.baseCells(); ++cell) item_.base(cell, 8, 8);
        item_.base(7, 0, 8);
        view_ = item_.view(1);
        pooled_.pool({&view_, 1});
    }

    void expectSure(const PooledBlock& block, int i, float visible) const {
        expectCell(block, i, visible, 1, 8, 8);
    }
    void expectUncertain(const PooledBlock& block, int i) const {
        expectCell(block, i, 0.75f, 1, 1, 1);
        EXPECT_EQ(block.effectiveRays(i), 1);
    }
};

TEST_F(OccluderCone, MakesTheVisibleCellsItMeetsUncertain) {
    constexpr float kAngle = 0.3f;
    const Vec3d axis = cellCenter(0, 3);
    pooled_.addOccluderCone(Vec3f(axis), kAngle);
    int met = 0, missed = 0;
    for (std::uint32_t cell = 0; cell < kTiers.baseCells(); ++cell) {
        const CellCap cap = cellCap(0, cell);
        const double apart = std::acos(std::min(1.0, cap.axis.dot(axis)));
        const PooledBlock& block = pooled_.base(cell / kBlockCells);
        const int i = static_cast<int>(cell % kBlockCells);
        if (cell == 7) {
            expectSure(block, i, 0);
        } else if (apart < cap.angle + static_cast<double>(kAngle)) {
            expectUncertain(block, i);
            ++met;
        } else {
            expectSure(block, i, 1);
            ++missed;
        }
    }
    EXPECT_GE(met, 4);
    EXPECT_GE(missed, 4);
}

TEST_F(OccluderCone, LeavesWhatIsOccludedSure) {
    pooled_.addOccluderCone(Vec3f(cellCenter(0, 7)), 0.01f);
    expectSure(pooled_.base(0), 7, 0);
}

TEST_F(OccluderCone, OfHalfATurnMeetsEverything) {
    pooled_.addOccluderCone({0, 1, 0}, static_cast<float>(kPi));
    for (std::uint32_t cell = 0; cell < kTiers.baseCells(); ++cell)
        if (cell != 7)
            expectUncertain(pooled_.base(cell / kBlockCells), static_cast<int>(cell % kBlockCells));
}

TEST_F(OccluderCone, SplitsTheBaseCellsItMeets) {
    EXPECT_FALSE(pooled_.hasChildren(0, 3));
    // In a corner of the cell, where it meets few of the cell's children.
    const Vec3d corner = cellTriangle(0, 3).a;
    pooled_.addOccluderCone(Vec3f(corner), 0.01f);
    EXPECT_TRUE(pooled_.hasChildren(0, 3));
    const PooledBlock* children = pooled_.children(0, 3);
    ASSERT_NE(children, nullptr);
    int met = 0;
    for (int i = 0; i < kBlockCells; ++i) {
        const CellCap cap = cellCap(2, 3 * kBlockCells + static_cast<std::uint32_t>(i));
        if (std::acos(std::min(1.0, cap.axis.dot(corner))) < cap.angle + 0.01) {
            expectUncertain(*children, i);
            ++met;
        } else {
            expectSure(*children, i, 1);
        }
    }
    EXPECT_GE(met, 1);
    EXPECT_LT(met, kBlockCells / 2);
    EXPECT_FALSE(pooled_.hasChildren(1, 3 * kBlockCells));
}

}  // namespace
}  // namespace shadowcache
