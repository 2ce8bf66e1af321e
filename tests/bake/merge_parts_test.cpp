// What a cache says of the bakes, shards and shots in it, and what a merge makes of that.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bake/core/cache_part.h"
#include "bake/core/merge.h"
#include "bake/core/merge_order.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

namespace fs = std::filesystem;
using test::bakeSmall;
using test::expectError;
using test::smallOptions;

TEST(BakeRecords, AreReadAsTheyAreWritten) {
    const std::vector<std::vector<BakeRecord>> lists{
        {},
        {{.seed = 7, .rays = 16}},
        {{1, 16, 8, {{0, 2}, {4, 4}}}, {18446744073709551615u, 255, 2, {{1, 1}}}},
    };
    for (const auto& bakes : lists) EXPECT_EQ(parseBakes(bakesText(bakes)), bakes);
    EXPECT_EQ(bakesText(lists[2]),
              "seed=1 rays=16 shards=1-3,5/8; seed=18446744073709551615 rays=255 shards=2/2");
    EXPECT_EQ(shardsText(missingShards(lists[2][0])), "4,6-8");
}

TEST(BakeRecords, OfAnotherFormAreRefused) {
    for (const char* text :
         {"seed=1", "seed=1 rays=", "seed= rays=1", "seed=1 rays=16 shards=", "seed=1 rays=16;",
          "seed=1 rays=16 shards=0/2", "seed=1 rays=16 shards=3/2", "seed=1 rays=16 shards=2-1/4",
          "seed=1 rays=16 shards=1,2/4", "seed=1 rays=16 shards=1,1/4", "seed=1 rays=16 x",
          "seed=-1 rays=16", "seed=1 rays=99999999999", "seed=1 rays=16 shards=1-99999999999/2"})
        EXPECT_FALSE(parseBakes(text)) << text;
    // Control.
    EXPECT_TRUE(parseBakes("seed=1 rays=16 shards=1,3/4"));
}

class MergeParts : public testing::Test {
protected:
    fs::path write(const std::string& name, const BakeResult& baked) const {
        writeCache(folder_.path() / name, baked.header, baked.items);
        return folder_.path() / name;
    }

    fs::path writeShard(int shard, int shards, std::uint64_t seed = 1) const {
        BakeOptions options = smallOptions(seed);
        options.shard = shard;
        options.shards = shards;
        const std::string name = fmt::format("part{}of{}seed{}.vdb", shard, shards, seed);
        return write(name, bakeSmall(options));
    }

    static CacheHeader merge(const std::vector<fs::path>& paths) {
        CacheHeader header;
        mergeCaches(paths, header);
        return header;
    }

    test::TemporaryFolder folder_;
};

TEST_F(MergeParts, NamesMissingShards) {
    const CacheHeader header = merge({writeShard(4, 6), writeShard(0, 6), writeShard(1, 6)});
    EXPECT_EQ(bakesText(header.bakes), "seed=1 rays=16 shards=1-2,5/6");
    EXPECT_EQ(missingText(header), "seed 1: shards 3-4,6 of 6");
    // Control: what was missing makes it whole.
    const BakeResult whole = bakeSmall(smallOptions());
    fs::path some = folder_.path() / "some.vdb";
    CacheHeader partHeader;
    const std::vector paths{writeShard(4, 6), writeShard(0, 6), writeShard(1, 6)};
    const CacheItems part = mergeCaches(paths, partHeader);
    writeCache(some, partHeader, part);
    const CacheHeader all = merge({some, writeShard(2, 6), writeShard(5, 6), writeShard(3, 6)});
    EXPECT_EQ(all.bakes, whole.header.bakes);
    EXPECT_EQ(missingText(all), "");
}

TEST_F(MergeParts, RefusesWhatIsThereAlready) {
    const fs::path first = writeShard(0, 3), second = writeShard(1, 3);
    const fs::path whole = write("whole.vdb", bakeSmall(smallOptions()));
    expectError(
        [&] {
            merge({first, second, first});
        },
        "part0of3seed1.vdb", "seed 1: shard 1 of 3 is in");
    expectError([&] { merge({whole, whole}); }, "whole.vdb", "seed 1 is in");
    expectError([&] { merge({whole, second}); }, "part1of3", "number of shards 3, expected 1");
    expectError([&] { merge({first, writeShard(1, 4)}); }, "part1of4", "number of shards 4");
    // Control: the same shards of another seed are other rays.
    EXPECT_EQ(bakesText(merge({first, writeShard(0, 3, 2), second}).bakes),
              "seed=1 rays=16 shards=1-2/3; seed=2 rays=16 shards=1/3");
}

TEST_F(MergeParts, RefusesOtherOptions) {
    const fs::path first = writeShard(0, 2);
    BakeOptions options = smallOptions();
    options.shard = 1;
    options.shards = 2;
    options.rays = 8;
    expectError(
        [&] {
            merge({first, write("rays.vdb", bakeSmall(options))});
        },
        "rays.vdb", "seed 1: rays 8, expected 16");
    options.rays = 16;
    BakeResult other = bakeSmall(options);
    other.header.version = "0.0.9";
    expectError(
        [&] {
            merge({first, write("version.vdb", other)});
        },
        "version.vdb", "program version 0.0.9");
}

/// Items of two shots of one bake are the same items: they are not counted twice.
TEST_F(MergeParts, KeepsItemsOfTwoShotsOnce) {
    const BakeResult whole = bakeSmall(smallOptions());
    const std::uint64_t sides = countSides(whole.items);
    BakeResult a = whole, b = whole;
    a.header.part = {sides, 2 * sides, "a"};
    b.header.part = {sides, 2 * sides, "b"};
    CacheHeader header;
    const std::vector paths{write("a.vdb", a), write("b.vdb", b)};
    const CacheItems both = mergeCaches(paths, header);
    EXPECT_EQ(both.d, whole.items.d);
    EXPECT_EQ(header.part->shots, "a; b");
    EXPECT_EQ(header.part->sides, sides);
    // Control: another seed's rays are counted.
    BakeResult c = bakeSmall(smallOptions(2));
    const std::vector seeds{paths[0], write("c.vdb", c)};
    EXPECT_GT(mergeCaches(seeds, header).d, whole.items.d);
    expectError(
        [&] {
            merge({paths[0], paths[1], write("again.vdb", a)});
        },
        "again.vdb", "seed 1 is in");
}

/// A shard of a shot is none of the whole set: much would be missing from their sum.
TEST_F(MergeParts, RefusesAShardOfAShotWithOneOfTheSet) {
    BakeOptions options = smallOptions();
    options.shards = 2;
    options.shard = 1;
    BakeResult second = bakeSmall(options);
    second.header.part = {countSides(second.items), 1000, "a"};
    const fs::path ofSet = writeShard(0, 2), ofShot = write("shot.vdb", second);
    expectError(
        [&] {
            merge({ofSet, ofShot});
        },
        "shot.vdb", "is of a shot, expected one of the whole set");
    expectError(
        [&] {
            merge({ofShot, ofSet});
        },
        "part0of2seed1.vdb", "is of the whole set, expected one of a shot");
    // Control.
    EXPECT_EQ(bakesText(merge({ofSet, writeShard(1, 2)}).bakes), "seed=1 rays=16");
}

/// Shards become shots, shots of one seed are kept once, seeds add up, in whatever order they come.
TEST_F(MergeParts, OfShotsOfSeveralSeedsInShardsAreOneInAnyOrder) {
    const auto shard = [&](std::uint64_t seed, const std::string& shot, int number) {
        BakeOptions options = smallOptions(seed);
        options.shards = 2;
        options.shard = number;
        BakeResult baked = bakeSmall(options);
        const std::uint64_t sides = countSides(baked.items);
        baked.header.part = {sides, 4 * sides, shot};
        return write(fmt::format("{}{}{}.vdb", shot, seed, number), baked);
    };
    std::vector<fs::path> paths;
    for (const int number : {0, 1})
        for (const char* shot : {"a", "b"})
            for (const std::uint64_t seed : {1, 2}) paths.push_back(shard(seed, shot, number));
    CacheHeader header;
    const CacheItems merged = mergeCaches(paths, header);
    EXPECT_EQ(bakesText(header.bakes), "seed=1 rays=16; seed=2 rays=16");
    EXPECT_EQ(header.part->shots, "a; b");
    const std::vector wholes{write("one.vdb", bakeSmall(smallOptions(1))),
                             write("two.vdb", bakeSmall(smallOptions(2)))};
    const CacheItems wanted = mergeCaches(wholes, header);
    EXPECT_EQ(merged.n, wanted.n);
    EXPECT_EQ(merged.d, wanted.d);
    // Control: a shard that is missing from one shot of one seed.
    paths.pop_back();
    expectError([&] { merge(paths); }, "b20.vdb", "shards of one of them are missing");
}

/// A tree of sums: the order of the caches, and how many there are, do not matter.
TEST_F(MergeParts, OfManyShardsAreTheOneBake) {
    constexpr int kShards = 37;
    std::vector<fs::path> paths;
    paths.reserve(kShards);
    for (int k = 0; k < kShards; ++k) paths.push_back(writeShard(k * 5 % kShards, kShards));
    CacheHeader header;
    const CacheItems merged = mergeCaches(paths, header);
    const BakeResult whole = bakeSmall(smallOptions());
    EXPECT_EQ(header.bakes, whole.header.bakes);
    EXPECT_EQ(merged.voxel, whole.items.voxel);
    EXPECT_EQ(merged.n, whole.items.n);
    EXPECT_EQ(merged.firstBlock, whole.items.firstBlock);
}

}  // namespace
}  // namespace shadowcache
