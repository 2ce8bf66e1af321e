// Caches of spatial shards and of several seeds become one.

#include "bake/core/merge.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

namespace fs = std::filesystem;
using test::bakeSmall;
using test::expectError;
using test::smallOptions;
using test::TemporaryFolder;

TEST(Merge, OfSpatialShardsIsTheOneBakeByteForByte) {
    const TemporaryFolder folder;
    const BakeResult whole = bakeSmall(smallOptions());
    writeCache(folder.path() / "whole.vdb", whole.header, whole.items);
    std::vector<fs::path> paths;
    std::size_t items = 0;
    std::uint64_t rays = 0;
    for (int shard = 0; shard < 3; ++shard) {
        BakeOptions options = smallOptions();
        options.shard = shard;
        options.shards = 3;
        const BakeResult part = bakeSmall(options);
        paths.push_back(folder.path() / fmt::format("part{}.vdb", shard));
        writeCache(paths.back(), part.header, part.items);
        items += part.items.size();
        rays += part.rays;
    }
    EXPECT_EQ(items, whole.items.size());
    // Neighbours of other shards get probe rays from both.
    EXPECT_GE(rays, whole.rays);
    EXPECT_LT(rays, 2 * whole.rays);
    for (int turn = 0; turn < 3; ++turn) {
        CacheHeader header;
        const CacheItems merged = mergeCaches(paths, header);
        writeCache(folder.path() / "merged.vdb", header, merged);
        EXPECT_EQ(header.bakes, whole.header.bakes);
        EXPECT_TRUE(test::readBytes(folder.path() / "merged.vdb") ==
                    test::readBytes(folder.path() / "whole.vdb"));
        std::rotate(paths.begin(), paths.begin() + 1, paths.end());
    }
}

TEST(Merge, OfTwoSeedsAddsTheCounts) {
    const TemporaryFolder folder;
    const BakeResult a = bakeSmall(smallOptions(1)), b = bakeSmall(smallOptions(2));
    ASSERT_EQ(a.items.voxel, b.items.voxel);
    EXPECT_NE(a.items.n, b.items.n);
    writeCache(folder.path() / "a.vdb", a.header, a.items);
    writeCache(folder.path() / "b.vdb", b.header, b.items);
    CacheHeader header;
    const CacheItems sum =
        mergeCaches(std::vector{folder.path() / "a.vdb", folder.path() / "b.vdb"}, header);
    EXPECT_EQ(header.seeds(), "1,2");
    ASSERT_EQ(sum.size(), a.items.size());
    for (std::size_t i = 0; i < sum.n.size(); ++i) {
        std::uint8_t n = a.items.n[i], d = a.items.d[i];
        addCounts(n, d, b.items.n[i], b.items.d[i]);
        EXPECT_EQ(sum.n[i], n);
        EXPECT_EQ(sum.d[i], d);
    }
    for (std::size_t i = 0; i < sum.size(); ++i)
        for (std::uint32_t k = sum.firstBlock[i] + 1; k < sum.firstBlock[i + 1]; ++k)
            EXPECT_LT(sum.blocks[k - 1].key, sum.blocks[k].key);
}

TEST(Merge, RefusesWhatDoesNotBelongTogether) {
    const TemporaryFolder folder;
    const auto write = [&](const std::string& name, const BakeResult& baked) {
        writeCache(folder.path() / name, baked.header, baked.items);
        return folder.path() / name;
    };
    BakeResult baked = bakeSmall(smallOptions());
    const fs::path first = write("first.vdb", baked);
    const auto refuse = [&](const std::string& name, const BakeResult& other,
                            const std::string& cause) {
        const fs::path path = write(name, other);
        CacheHeader header;
        expectError([&] { mergeCaches(std::vector{first, path}, header); }, name, cause);
    };
    BakeResult other = baked;
    other.header.fingerprint ^= 1;
    refuse("set.vdb", other, "fingerprint");
    other = baked;
    other.header.spacing = 0.3;
    refuse("spacing.vdb", other, "spacing 0.3");
    other = baked;
    other.header.adaptive = false;
    refuse("adaptive.vdb", other, "adaptive");
    BakeOptions coarse = smallOptions();
    coarse.level = 3;
    refuse("level.vdb", bakeSmall(coarse), "level 3");
}

}  // namespace
}  // namespace shadowcache
