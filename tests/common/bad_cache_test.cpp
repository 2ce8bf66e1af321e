// Cache files that cannot be read or written.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/cache/shadow_cache.h"
#include "tests/support/foreign_vdb.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

namespace fs = std::filesystem;
using test::bakeSmall;
using test::expectError;
using test::smallOptions;
using test::TemporaryFolder;

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
    EXPECT_EQ(test::filesIn(folder_.path()), 1u);
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
        EXPECT_EQ(test::filesIn(folder_.path()), 1u);
        EXPECT_TRUE(test::readBytes(path) == before) << "the older file is damaged";
    }
}

}  // namespace
}  // namespace shadowcache
