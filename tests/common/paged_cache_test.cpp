// A cache read in parts: the same items, and what becomes of damaged files.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "common/cache/checksums.h"
#include "common/cache/item_table.h"
#include "common/random/sequence.h"
#include "tests/support/plain_set.h"

namespace shadowcache::test {
namespace {

/// What a lookup found, without its pointers.
std::vector<int> contentOf(const ItemView& item, std::uint32_t cells) {
    std::vector<int> out(item.n, item.n + cells);
    out.insert(out.end(), item.d, item.d + cells);
    for (std::uint32_t b = 0; b < item.blockCount; ++b) {
        out.push_back(item.blockKeys[b]);
        for (std::uint32_t c = 0; c < kBlockCells; ++c) {
            out.push_back(item.blockN[b * item.blockNStep + c]);
            out.push_back(item.blockD[b * item.blockDStep + c]);
        }
    }
    return out;
}

void expectSameLookups(const ShadowCache& a, const ShadowCache& b, int places) {
    const std::uint32_t cells = a.header().tiers().baseCells();
    ShadowCache::Reader one(a), two(b);
    std::array<ItemView, ShadowCache::kMaxItems> foundOne, foundTwo;
    int found = 0;
    for (int i = 0; i < places; ++i) {
        const auto unit = [&](std::uint64_t k) {
            return toUnit(hashWords(7, static_cast<std::uint64_t>(i), k));
        };
        const Vec3d position(2 * unit(0) - 1, i % 2 ? 0 : 0.25 * unit(1), 2 * unit(2) - 1);
        const Vec3f normal = i % 3 == 0 ? Vec3f(0, 1, 0) : Vec3f(i % 3 == 1, 0, i % 3 == 2);
        const int count = one.lookUp(position, normal, foundOne);
        ASSERT_EQ(two.lookUp(position, normal, foundTwo), count);
        for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
            EXPECT_EQ(foundOne[k].weight, foundTwo[k].weight);
            EXPECT_EQ(foundOne[k].normal, foundTwo[k].normal);
            ASSERT_EQ(contentOf(foundOne[k], cells), contentOf(foundTwo[k], cells));
        }
        found += count;
    }
    EXPECT_GT(found, places / 2);
}

/// Numbers lead to what lookups find under them, in a cache that is whole and in one that is not.
void expectSameByNumber(const ShadowCache& whole, const ShadowCache& paged) {
    const std::uint32_t cells = whole.header().tiers().baseCells();
    ShadowCache::Reader looker(whole), one(whole), two(paged);
    const ItemTable table(whole);
    std::array<ItemView, ShadowCache::kMaxItems> found;
    std::size_t seen = 0, unlikeTheNext = 0;
    for (std::uint32_t i = 0; i < table.size(); ++i) {
        const std::uint32_t number = i % 3 ? i : static_cast<std::uint32_t>(table.size()) - 1 - i;
        const std::vector<int> content = contentOf(one.item(number), cells);
        EXPECT_EQ(one.item(number).number, number);
        EXPECT_EQ(one.item(number).normal, table.normal(number));
        ASSERT_EQ(contentOf(two.item(number), cells), content);
        unlikeTheNext += contentOf(one.item((number + 1) % table.size()), cells) != content;
        const int count = looker.lookUp(table.position(number), table.normal(number), found);
        const auto views = std::span(found).first(static_cast<std::size_t>(count));
        const auto self = std::ranges::find(views, std::uint64_t{number}, &ItemView::number);
        ASSERT_EQ(self != views.end(), table.isFound(number));
        if (self == views.end()) continue;
        ++seen;
        ASSERT_EQ(contentOf(*self, cells), content);
    }
    EXPECT_GT(seen, table.size() / 2);
    EXPECT_GT(unlikeTheNext, table.size() / 4) << "control";
}

TEST(MemoryBudget, FindsTheSameItemsAtEveryLevel) {
    for (int level = 0; level <= kMaxCacheLevel; ++level)
        for (const bool adaptive : {true, false}) {
            if (!adaptive && level == kMaxCacheLevel) continue;
            BakeOptions options;
            options.spacing = 0.11;
            options.level = level;
            options.adaptive = adaptive;
            options.rays = adaptive ? 4 : 1;
            const TemporaryFolder folder;
            const auto path = writePlain(folder, options);
            const ShadowCache whole(path), paged(path, 1);
            expectSameLookups(whole, paged, 300);
            expectSameByNumber(whole, paged);
            EXPECT_GT(paged.memoryUse().loads, 0u);
        }
}

TEST(MemoryBudget, OfACacheWithoutItems) {
    const TemporaryFolder folder;
    CacheHeader header;
    header.spacing = 1;
    const auto path = folder.path() / "cache.vdb";
    writeCache(path, header, {});
    const ShadowCache cache(path, 1000);
    EXPECT_EQ(cache.itemCount(), 0u);
    std::array<ItemView, ShadowCache::kMaxItems> found;
    EXPECT_EQ(ShadowCache::Reader(cache).lookUp({0, 0, 0}, {0, 1, 0}, found), 0);
}

class DamagedCache : public testing::Test {
protected:
    DamagedCache() {
        BakeOptions options;
        options.spacing = 0.1;
        options.level = 3;
        options.transport = false;  // renders of direct light do not read it
        path_ = writePlain(folder_, options);
        bytes_ = readBytes(path_);
    }

    TemporaryFolder folder_;
    std::filesystem::path path_;
    std::string bytes_;
};

TEST_F(DamagedCache, FailsARenderInOneLine) {
    // The last pages of the items are the last of the file, but for the checksums.
    std::string bytes = bytes_;
    const auto end = bytes.end() - static_cast<std::ptrdiff_t>(bytes.size() / kChecksumBytes * 8);
    std::fill(end - 600, end - 200, '\0');
    folder_.write("cache.vdb", bytes);
    for (const int threads : {1, 0}) {
        const ShadowCache cache(path_, 1 << 20);
        expectError([&] { renderPlain(cache, threads); }, "cache.vdb", "damaged");
    }
}

TEST_F(DamagedCache, CutShortOnceOpenFailsARenderInOneLine) {
    const ShadowCache cache(path_, 1);
    std::filesystem::resize_file(path_, bytes_.size() - 2 * kChecksumBytes);
    expectError([&] { renderPlain(cache, 0); }, "cache.vdb", "cut short while it was in use");
}

TEST_F(DamagedCache, CutShortBeforeIsRefused) {
    for (const double share : {0.1, 0.5, 0.9, 0.999}) {
        folder_.write(
            "cache.vdb",
            bytes_.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes_.size()))));
        expectError([&] { ShadowCache(path_, 1 << 20); }, "cache.vdb", "cut short");
    }
}

}  // namespace
}  // namespace shadowcache::test
