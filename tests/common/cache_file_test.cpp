// What is written is read; lookup and sides; stock OpenVDB and `vdb_print` read it.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "bake/core/baker.h"
#include "common/cache/cache_items.h"
#include "common/cache/shadow_cache.h"
#include "common/mesh/mesh_fingerprint.h"
#include "tests/support/foreign_vdb.h"
#include "tests/support/needs.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

namespace fs = std::filesystem;
using test::bakeSmall;
using test::smallOptions;
using test::TemporaryFolder;

void expectSameItems(const CacheItems& a, const CacheItems& b) {
    EXPECT_EQ(a.voxel, b.voxel);
    EXPECT_EQ(a.patch, b.patch);
    EXPECT_EQ(a.normal, b.normal);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.n, b.n);
    EXPECT_EQ(a.d, b.d);
    EXPECT_EQ(a.firstBlock, b.firstBlock);
    ASSERT_EQ(a.blocks.size(), b.blocks.size());
    for (std::size_t i = 0; i < a.blocks.size(); ++i) {
        EXPECT_EQ(a.blocks[i].key, b.blocks[i].key);
        EXPECT_EQ(a.blocks[i].n, b.blocks[i].n);
        EXPECT_EQ(a.blocks[i].d, b.blocks[i].d);
    }
}

TEST(CacheFile, ReadsBackWhatWasWritten) {
    const TemporaryFolder folder;
    for (int level = 0; level <= kMaxCacheLevel; ++level) {
        BakeOptions options = smallOptions();
        options.spacing = 0.5;
        options.level = level;
        BakeResult baked = bakeSmall(options);
        baked.header.upAxis = "z";
        baked.header.unit = 0.01;
        const fs::path path = folder.path() / "cache.vdb";
        const std::uintmax_t bytes = writeCache(path, baked.header, baked.items);
        EXPECT_EQ(bytes, fs::file_size(path));
        CacheHeader header;
        expectSameItems(readCache(path, header), baked.items);
        EXPECT_EQ(header.level, level);
        EXPECT_EQ(header.spacing, 0.5);
        EXPECT_EQ(header.rays(), options.rays);
        EXPECT_EQ(header.seeds(), "1");
        EXPECT_EQ(header.upAxis, "z");
        EXPECT_EQ(header.unit, 0.01);
        EXPECT_EQ(header.fingerprint, fingerprint(test::smallMesh()));
        EXPECT_EQ(header.version, baked.header.version);
        const ShadowCache open(path);
        EXPECT_EQ(open.itemCount(), baked.items.size());
        EXPECT_EQ(open.blockCount(), baked.items.blocks.size());
        EXPECT_GT(open.memoryBytes(), baked.items.n.size());
    }
    EXPECT_EQ(test::filesIn(folder.path()), 1u);
}

TEST(CacheLookup, FindsTheItemsAround) {
    const BakeResult baked = bakeSmall(smallOptions());
    const test::TestCache cache(baked);
    ShadowCache::Reader reader(cache.cache());
    const CacheItems& items = baked.items;
    const std::size_t cells = baked.header.tiers().baseCells();
    std::array<ItemView, ShadowCache::kMaxItems> found;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Vec3d position = (Vec3d(items.voxel[i]) + Vec3d(items.position[i])) * 0.25;
        const int count = reader.lookUp(position, items.normal[i], found);
        ASSERT_GT(count, 0);
        float sum = 0;
        bool own = false;
        for (int k = 0; k < count; ++k) {
            const ItemView& view = found[static_cast<std::size_t>(k)];
            sum += view.weight;
            EXPECT_GE(view.weight, 0.0f);
            EXPECT_GT(view.normal.dot(items.normal[i]), 0.0f) << "an item of the other side";
            own = own || (view.normal == items.normal[i] &&
                          std::equal(view.n, view.n + cells, items.n.data() + i * cells) &&
                          std::equal(view.d, view.d + cells, items.d.data() + i * cells) &&
                          view.blockCount == items.firstBlock[i + 1] - items.firstBlock[i]);
        }
        EXPECT_TRUE(own) << i;
        EXPECT_NEAR(sum, 1.0f, 1e-5f);
    }
    EXPECT_EQ(reader.lookUp({50, 50, 50}, {0, 1, 0}, found), 0);
}

TEST(CacheLookup, TellsTheSidesOfAThinWallApart) {
    // A closed box under the open sky, walls far thinner than a voxel.
    TriangleMesh mesh;
    test::addBox(mesh, {-1, -1, -1}, {1, 1, 1});
    test::addBox(mesh, {-0.999f, -0.999f, -0.999f}, {0.999f, 0.999f, 0.999f});
    const Scene scene(mesh);
    BakeOptions options = smallOptions();
    const test::TestCache cache(bake(scene, options));
    ShadowCache::Reader reader(cache.cache());
    std::array<ItemView, ShadowCache::kMaxItems> found;
    const std::size_t cells = cache.cache().header().tiers().baseCells();
    const auto visibleShare = [&](const Vec3d& position, const Vec3f& normal) {
        const int count = reader.lookUp(position, normal, found);
        EXPECT_GT(count, 0);
        double visible = 0, counted = 0;
        for (int k = 0; k < count; ++k)
            for (std::size_t c = 0; c < cells; ++c) {
                visible += found[static_cast<std::size_t>(k)].n[c];
                counted += found[static_cast<std::size_t>(k)].d[c];
            }
        return visible / counted;
    };
    for (const double z : {-0.6, -0.1, 0.33}) {
        EXPECT_EQ(visibleShare({0.999, 0.1, z}, {-1, 0, 0}), 0.0);
        // The space between the two walls is dark, and its items point outward, too.
        EXPECT_GT(visibleShare({1, 0.1, z}, {1, 0, 0}), 0.4);
    }
}

TEST(CacheFile, OpensWithStockOpenVdb) {
    const BakeResult baked = bakeSmall(smallOptions());
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "cache.vdb";
    writeCache(path, baked.header, baked.items);
    const test::StockReading reading = test::readWithStockOpenVdb(path);
    std::uint64_t visible = 0, counted = 0;
    for (std::size_t i = 0; i < baked.items.n.size(); ++i) {
        visible += baked.items.n[i];
        counted += baked.items.d[i];
    }
    EXPECT_EQ(reading.points, baked.items.size());
    EXPECT_EQ(reading.blocks, baked.items.blocks.size());
    EXPECT_EQ(reading.sumN, visible);
    EXPECT_EQ(reading.sumD, counted);
    EXPECT_EQ(reading.voxelSize, 0.25);
    EXPECT_GT(reading.openVoxels, 0u);
    EXPECT_GE(reading.minOpenness, 0.0);
    EXPECT_LE(reading.maxOpenness, 1.0);
    EXPECT_LE(reading.longestDirection, 1.001);
}

TEST(CacheFile, IsPrintedByVdbPrint) {
    SHADOWCACHE_NEEDS("vdb_print (Debian package: libopenvdb-tools)", "command -v vdb_print");
    const BakeResult baked = bakeSmall(smallOptions());
    const TemporaryFolder folder;
    writeCache(folder.path() / "cache.vdb", baked.header, baked.items);
    for (const std::string option : {"", "-l", "-m"}) {
        const std::string out = (folder.path() / "out.txt").string();
        EXPECT_EQ(std::system(("vdb_print " + option + " '" +
                               (folder.path() / "cache.vdb").string() + "' > '" + out + "' 2>&1")
                                  .c_str()),
                  0);
        const std::string text = test::readBytes(out);
        for (const char* grid :
             {"shadowcache_items", "shadowcache_blocks", "openness", "open_direction"})
            EXPECT_NE(text.find(grid), std::string::npos) << option << ": " << text;
        EXPECT_EQ(text.find("Error"), std::string::npos) << text;
    }
}

}  // namespace
}  // namespace shadowcache
