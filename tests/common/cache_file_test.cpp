#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "bake/core/baker.h"
#include "bake/core/merge.h"
#include "common/base/sequence.h"
#include "common/cache/cache_items.h"
#include "common/cache/shadow_cache.h"
#include "common/mesh/mesh_fingerprint.h"
#include "tests/support/foreign_vdb.h"
#include "tests/support/needs.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

namespace fs = std::filesystem;
using test::expectError;
using test::TemporaryFolder;

/// Floor, box and a roof: a few hundred items.
TriangleMesh smallMesh() {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -1, 1, -1, 1);
    test::addBox(mesh, {-0.3f, 0, -0.3f}, {0.4f, 0.6f, 0.5f});
    test::addFloor(mesh, 1.1f, -1, 0, -1, 1);
    return mesh;
}

BakeResult bakeSmall(const BakeOptions& options) {
    const TriangleMesh mesh = smallMesh();
    const Scene scene(mesh);
    return bake(scene, options);
}

BakeOptions smallOptions(std::uint64_t seed = 1) {
    BakeOptions options;
    options.spacing = 0.25;
    options.seed = seed;
    return options;
}

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

std::size_t filesIn(const fs::path& folder) {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
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
        EXPECT_EQ(header.rays, options.rays);
        EXPECT_EQ(header.seeds, "1");
        EXPECT_EQ(header.upAxis, "z");
        EXPECT_EQ(header.unit, 0.01);
        EXPECT_EQ(header.fingerprint, fingerprint(smallMesh()));
        EXPECT_EQ(header.version, baked.header.version);
        const ShadowCache open(path);
        EXPECT_EQ(open.itemCount(), baked.items.size());
        EXPECT_EQ(open.blockCount(), baked.items.blocks.size());
        EXPECT_GT(open.memoryBytes(), baked.items.n.size());
    }
    EXPECT_EQ(filesIn(folder.path()), 1u);
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
    const auto openShare = [&](const Vec3d& position, const Vec3f& normal) {
        const int count = reader.lookUp(position, normal, found);
        EXPECT_GT(count, 0);
        double open = 0, counted = 0;
        for (int k = 0; k < count; ++k)
            for (std::size_t c = 0; c < cells; ++c) {
                open += found[static_cast<std::size_t>(k)].n[c];
                counted += found[static_cast<std::size_t>(k)].d[c];
            }
        return open / counted;
    };
    for (const double z : {-0.6, -0.1, 0.33}) {
        EXPECT_EQ(openShare({0.999, 0.1, z}, {-1, 0, 0}), 0.0);
        // The space between the two skins is dark, and its items point outward, too.
        EXPECT_GT(openShare({1, 0.1, z}, {1, 0, 0}), 0.4);
    }
}

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
        paths.push_back(folder.path() / ("part" + std::to_string(shard) + ".vdb"));
        writeCache(paths.back(), part.header, part.items);
        items += part.items.size();
        rays += part.rays;
    }
    EXPECT_EQ(items, whole.items.size());
    // Neighbours of other shards are probed by both.
    EXPECT_GE(rays, whole.rays);
    EXPECT_LT(rays, 2 * whole.rays);
    for (int turn = 0; turn < 3; ++turn) {
        CacheHeader header;
        const CacheItems merged = mergeCaches(paths, header);
        writeCache(folder.path() / "merged.vdb", header, merged);
        EXPECT_EQ(test::withoutUuids(test::readBytes(folder.path() / "merged.vdb")),
                  test::withoutUuids(test::readBytes(folder.path() / "whole.vdb")));
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
    EXPECT_EQ(header.seeds, "1,2");
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

class BadCacheFiles : public testing::Test {
protected:
    TemporaryFolder folder_;

    void refuse(const fs::path& path, const std::string& cause) const {
        CacheHeader header;
        expectError([&] { readCache(path, header); }, path.filename().string(), cause);
        expectError([&] { ShadowCache cache(path); }, path.filename().string(), cause);
    }
};

/// Numbers that would lead a reader out of its arrays, or that no bake writes, are refused whether
/// the cache is read as items or opened for lookups.
TEST_F(BadCacheFiles, WithUnsoundNumbersAreRefused) {
    const BakeResult baked = bakeSmall(smallOptions());
    std::size_t refined = 0;  // an item of two blocks at least
    while (baked.items.firstBlock[refined + 1] - baked.items.firstBlock[refined] < 2) ++refined;
    const std::size_t first = baked.items.firstBlock[refined];
    const auto refuseChanged = [&](const char* name, const std::string& cause, auto change) {
        CacheItems items = baked.items;
        change(items);
        const fs::path path = folder_.path() / name;
        writeCache(path, baked.header, items);
        refuse(path, cause);
    };
    refuseChanged("patch.vdb", "an item's patch does not exist",
                  [&](CacheItems& items) { items.patch[refined] = 30000; });
    refuseChanged("order.vdb", "an item's blocks are not in order", [&](CacheItems& items) {
        std::swap(items.blocks[first], items.blocks[first + 1]);
    });
    refuseChanged("twice.vdb", "an item's blocks are not in order", [&](CacheItems& items) {
        items.blocks[first + 1].key = items.blocks[first].key;
    });
    refuseChanged(
        "key.vdb", "a block refines a region that does not exist",
        [&](CacheItems& items) { items.blocks[items.firstBlock[refined + 1] - 1].key = 20000; });
    // Control: unchanged it is read.
    const fs::path path = folder_.path() / "sound.vdb";
    writeCache(path, baked.header, baked.items);
    CacheHeader header;
    EXPECT_EQ(readCache(path, header).size(), baked.items.size());
}

TEST_F(BadCacheFiles, AreRefused) {
    refuse(folder_.path() / "missing.vdb", "no such file");
    refuse(folder_.write("empty.vdb", ""), "empty");
    refuse(folder_.write("text.vdb", "these are not the voxels you are looking for\n"), "OpenVDB");
    refuse(folder_.write("exr.vdb", std::string("\x76\x2f\x31\x01", 4) + std::string(500, '\0')),
           "OpenVDB");
    fs::create_directory(folder_.path() / "folder.vdb");
    refuse(folder_.path() / "folder.vdb", "directory");
    test::writeForeignVdb(folder_.path() / "foreign.vdb");
    refuse(folder_.path() / "foreign.vdb", "not a shadow cache");
}

TEST_F(BadCacheFiles, CutShortAreRefused) {
    const BakeResult baked = bakeSmall(smallOptions());
    writeCache(folder_.path() / "whole.vdb", baked.header, baked.items);
    const std::string bytes = test::readBytes(folder_.path() / "whole.vdb");
    for (const double share : {0.0001, 0.001, 0.01, 0.1, 0.3, 0.5, 0.7})
        refuse(folder_.write(
                   "cut.vdb",
                   bytes.substr(
                       0, static_cast<std::size_t>(share * static_cast<double>(bytes.size())) + 1)),
               "");
}

TEST_F(BadCacheFiles, OfANewerFormatAreRefused) {
    const BakeResult baked = bakeSmall(smallOptions());
    const fs::path path = folder_.path() / "newer.vdb";
    writeCache(path, baked.header, baked.items);
    test::setFileMetadata(path, "shadowcache_format", kCacheFormat + 1);
    refuse(path, "newer version");
}

TEST_F(BadCacheFiles, WithPatchesThatCannotBeAreRefused) {
    BakeResult baked = bakeSmall(smallOptions());
    const fs::path path = folder_.path() / "patch.vdb";
    const auto write = [&](int patch) {
        baked.items.patch.back() = static_cast<std::int16_t>(patch);
        writeCache(path, baked.header, baked.items);
    };
    // Below all sides and above them; subpatches of something that is not cut.
    for (const int patch : {-1, kSubpatchCodes * kMaxDepthLayers * kSides, 1, 5}) {
        write(patch);
        refuse(path, "patch does not exist");
    }
    write(25 + 5 + 1);
    EXPECT_NO_THROW(ShadowCache cache(path)) << "control: a quarter of a quarter of a quarter";
}

TEST_F(BadCacheFiles, ThatCannotBeWrittenLeaveNothing) {
    const BakeResult baked = bakeSmall(smallOptions());
    const auto write = [&](const fs::path& path) { writeCache(path, baked.header, baked.items); };
    expectError([&] { write(folder_.path() / "no" / "folder" / "cache.vdb"); }, "cache.vdb",
                "cannot be created");
    fs::create_directory(folder_.path() / "folder.vdb");
    expectError([&] { write(folder_.path() / "folder.vdb"); }, "folder.vdb", "directory");
    EXPECT_EQ(filesIn(folder_.path()), 1u);
}

TEST_F(BadCacheFiles, OnAFullDiskLeaveNothing) {
    const BakeResult baked = bakeSmall(smallOptions());
    const fs::path path = folder_.path() / "cache.vdb";
    const auto whole = writeCache(path, baked.header, baked.items);
    const std::string before = test::readBytes(path);
    for (const double share : {0.02, 0.5, 0.98}) {
        const pid_t child = fork();
        if (child == 0) {
            // A limit on the file's size is the full disk that needs no disk.
            signal(SIGXFSZ, SIG_IGN);
            const auto most = static_cast<rlim_t>(share * static_cast<double>(whole));
            const rlimit limit{most, most};
            setrlimit(RLIMIT_FSIZE, &limit);
            int status = 1;
            try {
                writeCache(path, baked.header, baked.items);
            } catch (const Error& e) {
                status = std::string(e.what()).find("cache.vdb") != std::string::npos ? 42 : 2;
            }
            _exit(status);
        }
        int status = 0;
        ASSERT_EQ(waitpid(child, &status, 0), child);
        EXPECT_TRUE(WIFEXITED(status));
        EXPECT_EQ(WEXITSTATUS(status), 42) << share;
        EXPECT_EQ(filesIn(folder_.path()), 1u);
        EXPECT_TRUE(test::readBytes(path) == before) << "the older file is damaged";
    }
}

TEST(CacheFile, OpensWithStockOpenVdb) {
    const BakeResult baked = bakeSmall(smallOptions());
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "cache.vdb";
    writeCache(path, baked.header, baked.items);
    const test::StockReading reading = test::readWithStockOpenVdb(path);
    std::uint64_t open = 0, counted = 0;
    for (std::size_t i = 0; i < baked.items.n.size(); ++i) {
        open += baked.items.n[i];
        counted += baked.items.d[i];
    }
    EXPECT_EQ(reading.points, baked.items.size());
    EXPECT_EQ(reading.blocks, baked.items.blocks.size());
    EXPECT_EQ(reading.sumN, open);
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
