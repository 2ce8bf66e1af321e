// A bit of a cache file that has changed is noticed before anything is decoded.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "common/cache/cache_items.h"
#include "common/cache/checksums.h"
#include "common/cache/shadow_cache.h"
#include "common/random/sequence.h"
#include "tests/support/plain_set.h"

namespace shadowcache::test {
namespace {

namespace fs = std::filesystem;

class FlippedBit : public testing::Test {
protected:
    FlippedBit() {
        BakeOptions options;
        options.spacing = 0.4;
        options.level = 3;
        path_ = writePlain(folder_, options);
        bytes_ = readBytes(path_);
    }

    /// Writes the file with one bit changed.
    void flip(std::size_t byte, unsigned bit) const {
        std::string bytes = bytes_;
        bytes[byte] = static_cast<char>(bytes[byte] ^ (1 << bit));
        folder_.write("cache.vdb", bytes);
    }

    /// Looks up places all over the set.
    static std::size_t lookUpAll(const ShadowCache& cache) {
        ShadowCache::Reader reader(cache);
        std::array<ItemView, ShadowCache::kMaxItems> found;
        std::size_t count = 0;
        for (int x = -2; x <= 2; ++x)
            for (int z = -2; z <= 2; ++z)
                for (const float y : {1.0f, -1.0f})
                    count += static_cast<std::size_t>(
                        reader.lookUp({0.4 * x, 0, 0.4 * z}, {0, y, 0}, found));
        return count;
    }

    TemporaryFolder folder_;
    fs::path path_;
    std::string bytes_;
};

/// Runs `read` on the file and expects one line that names it.
template <class Read>
void expectRefused(const Read& read, std::size_t byte) {
    SCOPED_TRACE(fmt::format("byte {}", byte));
    expectError(read, "cache.vdb: ", "");
}

constexpr std::size_t kPlaces = 1000;

/// Every part of the file is met: its head, each grid, the checksums themselves.
TEST_F(FlippedBit, IsRefusedWhereverItIs) {
    for (std::size_t i = 0; i < kPlaces; ++i) {
        const std::size_t byte = i * bytes_.size() / kPlaces;
        flip(byte, static_cast<unsigned>(hashWords(1, i) % 8));
        CacheHeader header;
        expectRefused([&] { readCache(path_, header); }, byte);
        if (i % 10 == 0) {
            expectRefused([&] { ShadowCache cache(path_); }, byte);
            expectRefused([&] { verifyCache(path_); }, byte);
        }
    }
}

/// With a memory budget only what is read is checked: what is not refused is right.
TEST_F(FlippedBit, FailsALookupOrDoesNotConcernIt) {
    const std::size_t expected = lookUpAll(ShadowCache(path_, 1 << 20));
    std::size_t refused = 0;
    for (std::size_t i = 0; i < kPlaces; ++i) {
        const std::size_t byte = i * bytes_.size() / kPlaces;
        flip(byte, static_cast<unsigned>(hashWords(2, i) % 8));
        try {
            EXPECT_EQ(lookUpAll(ShadowCache(path_, 1 << 20)), expected) << byte;
        } catch (const Error& e) {
            const std::string text = e.what();
            EXPECT_NE(text.find("cache.vdb: "), std::string::npos) << text;
            EXPECT_EQ(text.find('\n'), std::string::npos) << text;
            ++refused;
        }
    }
    EXPECT_GT(refused, kPlaces / 2);
    EXPECT_LT(refused, kPlaces) << "the grids for volume tools are not read";
}

/// Control: the file as it was is whole.
TEST_F(FlippedBit, IsNotSeenWhereThereIsNone) {
    const CacheCheck check = verifyCache(path_);
    EXPECT_EQ(check.bytes, bytes_.size());
    EXPECT_EQ(check.checksums, CheckedFile::open(path_)->pieces());
    EXPECT_GT(check.items, 0u);
}

/// A flip is found in the piece that it is in, and the grid is named.
TEST_F(FlippedBit, IsNamed) {
    const std::size_t byte = bytes_.size() - bytes_.size() / 8;
    flip(byte, 3);
    const auto file = CheckedFile::open(path_);
    ASSERT_TRUE(file);
    EXPECT_EQ(file->damaged(), std::vector{byte / kChecksumBytes * kChecksumBytes});
    expectError([&] { verifyCache(path_); }, "cache.vdb", "in grid 'shadowcache_items'");
}

/// A part of the file of another one, with checksums of its own, is noticed as well.
TEST_F(FlippedBit, OrACutIsNoticed) {
    for (const std::size_t size : {std::size_t{0}, std::size_t{31}, std::size_t{32},
                                   bytes_.size() / 2, bytes_.size() - 32, bytes_.size() - 1}) {
        folder_.write("cache.vdb", bytes_.substr(0, size));
        CacheHeader header;
        expectRefused([&] { readCache(path_, header); }, size);
    }
    folder_.write("cache.vdb", bytes_ + bytes_);
    CacheHeader header;
    expectRefused([&] { readCache(path_, header); }, 2 * bytes_.size());
}

}  // namespace
}  // namespace shadowcache::test
