// How far a block of tiles is, told in tiles.

#include "render/frame/block_progress.h"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

#include "common/base/parallel.h"

namespace shadowcache {
namespace {

TEST(BlockProgress, TellsOfTilesAsWorkIsDone) {
    std::vector<std::size_t> told;
    BlockProgress progress(3, 12, [&](std::size_t more) { told.push_back(more); });
    progress.add(3);
    EXPECT_TRUE(told.empty());
    progress.add(1);
    EXPECT_EQ(told, std::vector<std::size_t>({1}));
    progress.add(7);
    EXPECT_EQ(told, std::vector<std::size_t>({1, 1}));
    progress.finish();
    EXPECT_EQ(told, std::vector<std::size_t>({1, 1, 1}));
    progress.finish();
    EXPECT_EQ(told.size(), 3u);
}

TEST(BlockProgress, NeverTellsOfMoreThanThereAre) {
    std::size_t told = 0;
    BlockProgress progress(3, 12, [&](std::size_t more) { told += more; });
    progress.add(50);
    progress.add(50);
    progress.finish();
    EXPECT_EQ(told, 3u);
}

TEST(BlockProgress, TellsOfEveryTileOnceWhateverTheThreads) {
    std::atomic<std::size_t> told{0};
    BlockProgress progress(17, 4000, [&](std::size_t more) { told += more; });
    parallelFor(4000, 1, [&](const Chunk& chunk) { progress.add(chunk.end - chunk.begin); });
    EXPECT_EQ(told, 17u);
}

}  // namespace
}  // namespace shadowcache
