// Where the hemisphere above a place is split: the marks of sixteen cells, case by case.

#include "common/predict/cell_splits.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

namespace shadowcache {
namespace {

Environment constantSky(float radiance) {
    return {{1, 1, {Rgb(radiance)}}, 0, {0.2126f, 0.7152f, 0.0722f}};
}

/// Finer counts of the cells that are named, whatever the tier.
struct Children {
    std::set<std::uint32_t> cells;
    bool hasChildren(int, std::uint32_t cell) const { return cells.count(cell) > 0; }
};

class CellSplits : public testing::Test {
protected:
    const Environment sky_ = constantSky(2);
    CellLight light_{};
    alignas(64) float c_[kBlockCells] = {};
    Children children_;

    CellSplits() {
        for (int i = 0; i < kBlockCells; ++i) light_.cosineMoment[i] = light_.fitMoment[i] = 1;
    }

    void set(std::size_t i, float light, float visible) {
        light_.light[i] = light;
        c_[i] = visible;
    }
    /// Cuts cell i by the horizon: the stand-in of the cosine misses `error` of its mean square.
    void cut(std::size_t i, float error) {
        light_.anyHorizon = true;
        light_.cosineMoment[i] = 0.5f;
        light_.fitMoment[i] = 0.5f - error;
    }

    /// Cells of block 2 of a tier that are split where noise of 1 is too much.
    std::set<int> split(int level, int tier = 0) const {
        const CellSplitter splitter(sky_, DirectionTiers{level});
        Splits splits;
        splitter.mark(children_, tier, 2, light_, c_, 1.0f, splits);
        std::set<int> visited;
        int last = -1;
        splits.forEach([&](int i) {
            EXPECT_GT(i, last) << "in order";
            last = i;
            visited.insert(i);
        });
        EXPECT_EQ(splits.any, !visited.empty());
        for (int i = 0; splits.any && i < kBlockCells; ++i)
            EXPECT_EQ(splits.marks[i], visited.count(i)) << i;
        return visited;
    }
};

TEST_F(CellSplits, LeastNoiseIsAShareOfTheSky) {
    const CellSplitter splitter(sky_, DirectionTiers{5});
    EXPECT_NEAR(splitter.leastNoise(), 5e-4 * 2 * 4 * std::numbers::pi, 1e-6);
}

TEST_F(CellSplits, MixedCellsWithFinerCountsAreSplitIfBright) {
    children_.cells = {2 * 16 + 0, 2 * 16 + 2, 2 * 16 + 3, 2 * 16 + 4, 2 * 16 + 15};
    set(0, 2.01f, 0.5f);  // light^2 c (1 - c) = 1.01
    set(1, 2.01f, 0.5f);  // no finer counts
    set(2, 1.99f, 0.5f);  // 0.99
    set(3, 1000, 1);      // all visible
    set(4, 1000, 0);      // all occluded
    set(15, 4, 0.9f);     // 1.44
    EXPECT_EQ(split(5), (std::set<int>{0, 15}));
}

TEST_F(CellSplits, TheBlockOfTheCellCounts) {
    children_.cells = {0, 16};  // of other blocks
    set(0, 100, 0.5f);
    EXPECT_EQ(split(5), std::set<int>{});
}

TEST_F(CellSplits, CellsOnTheHorizonNeedNoCounts) {
    set(1, 10, 1);
    cut(1, 0.011f);  // light^2 c^2 error = 1.1
    set(2, 10, 1);
    cut(2, 0.009f);  // 0.9
    set(3, 10, 0.5f);
    cut(3, 0.03f);  // 0.75; and mixed, but without finer counts
    set(4, 10, 0);
    cut(4, 0.5f);  // nothing is visible
    EXPECT_EQ(split(5), std::set<int>{1});
}

TEST_F(CellSplits, TheFinestTierIsSplitOnTheHorizonAlone) {
    children_.cells = {2 * 16 + 0, 2 * 16 + 1};
    set(0, 100, 0.5f);
    EXPECT_EQ(split(2, 0), std::set<int>{0});
    EXPECT_EQ(split(2, 1), std::set<int>{}) << "level 2 is the finest that was counted";
    set(1, 100, 1);
    cut(1, 0.1f);
    EXPECT_EQ(split(2, 1), std::set<int>{1});
}

TEST_F(CellSplits, TheFinestCellsOfTheMapStayWhole) {
    set(1, 100, 1);
    cut(1, 0.1f);
    EXPECT_EQ(split(5, 1), std::set<int>{1});  // level 3
    EXPECT_EQ(split(5, 2), std::set<int>{});   // level 5
    EXPECT_EQ(split(4, 1), std::set<int>{1});  // level 2
    EXPECT_EQ(split(4, 2), std::set<int>{});   // level 4: 6 is finer than the map's table
}

}  // namespace
}  // namespace shadowcache
