// What a bake has finished is a cache, whenever it is asked for.

#include "bake/core/partial_cache.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

constexpr double kNever = 1e6;  // seconds

BakeOptions fineOptions() {
    BakeOptions options = test::smallOptions();
    options.spacing = 0.1;
    return options;
}

class PartialCacheTest : public testing::Test {
protected:
    test::TemporaryFolder folder_;
    const TriangleMesh mesh_ = test::smallMesh();
    const Scene scene_{mesh_};
    const BakeOptions options_ = fineOptions();
    Checkpoint checkpoint_{folder_.path() / "a.vdb", {}, kNever};
    PartialCache partial_;
};

TEST_F(PartialCacheTest, IsTheCacheOnceAllIsFinished) {
    EXPECT_EQ(partial_.now(), nullptr) << "no bake has begun";
    {
        const PartialCache::Source source(&partial_, headerOf(mesh_, options_), checkpoint_);
        EXPECT_EQ(partial_.now(), nullptr) << "nothing is finished";
        const BakeResult whole = bake(scene_, options_, {}, &checkpoint_);
        const auto cache = partial_.now();
        ASSERT_NE(cache, nullptr);
        const CacheItems items = itemsOf(*cache);
        EXPECT_EQ(items.voxel, whole.items.voxel);
        EXPECT_EQ(items.patch, whole.items.patch);
        EXPECT_EQ(items.n, whole.items.n);
        EXPECT_EQ(items.d, whole.items.d);
        EXPECT_EQ(items.hits, whole.items.hits);
        EXPECT_EQ(cache->header().fingerprint, whole.header.fingerprint);
    }
    EXPECT_EQ(partial_.now(), nullptr) << "the bake is over";
}

// Who looks on disturbs nothing, and sees items of the bake.
TEST_F(PartialCacheTest, GrowsWhileItIsLookedAt) {
    const BakeResult alone = bake(scene_, options_);
    const PartialCache::Source source(&partial_, headerOf(mesh_, options_), checkpoint_);
    std::jthread looks([&](const std::stop_token& stop) {
        std::size_t before = 0;
        while (!stop.stop_requested()) {
            const auto cache = partial_.now();
            if (!cache) continue;
            EXPECT_GE(cache->itemCount(), before);
            EXPECT_LE(cache->itemCount(), alone.items.size());
            before = cache->itemCount();
        }
    });
    const BakeResult watched = bake(scene_, options_, {}, &checkpoint_);
    looks.request_stop();
    looks.join();
    EXPECT_EQ(watched.items.voxel, alone.items.voxel);
    EXPECT_EQ(watched.items.n, alone.items.n);
    EXPECT_EQ(watched.items.d, alone.items.d);
}

// Few items may stay in memory: the bake reads the others back while they are being written.
TEST_F(PartialCacheTest, OfABakeOfBoundedMemory) {
    const BakeResult alone = bake(scene_, options_);
    Checkpoint bounded(folder_.path() / "b.vdb", {}, kNever, 20000);
    const PartialCache::Source source(&partial_, headerOf(mesh_, options_), bounded);
    std::jthread looks([&](const std::stop_token& stop) {
        while (!stop.stop_requested()) partial_.now();
    });
    const BakeResult watched = bake(scene_, options_, {}, &bounded);
    EXPECT_EQ(watched.items.n, alone.items.n);
    EXPECT_EQ(watched.items.d, alone.items.d);
}

}  // namespace
}  // namespace shadowcache
