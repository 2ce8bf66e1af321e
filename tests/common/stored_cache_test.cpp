// Cache files that earlier programs wrote, kept in tests/stored: those of formats that are read
// have every number that was written; those of an older one are refused with what to do.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "common/cache/cache_items.h"
#include "common/cache/shadow_cache.h"
#include "common/cache/transport.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

namespace fs = std::filesystem;

fs::path stored(const std::string& name) {
    return fs::path(SHADOWCACHE_STORED) / (name + ".vdb");
}

/// FNV-1a of numbers, low byte first: written here, so that it is the same in years.
class Digest {
public:
    void add(std::uint32_t number) {
        for (int byte = 0; byte < 4; ++byte)
            value_ = (value_ ^ (number >> 8 * byte & 0xff)) * 0x100000001b3u;
    }
    void add(float number) { add(std::bit_cast<std::uint32_t>(number)); }
    std::uint64_t value() const { return value_; }

private:
    std::uint64_t value_ = 0xcbf29ce484222325u;
};

std::uint64_t digestOf(const CacheItems& items) {
    Digest digest;
    for (std::size_t i = 0; i < items.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            digest.add(static_cast<std::uint32_t>(items.voxel[i][k]));
            digest.add(items.normal[i][k]);
            digest.add(items.position[i][k]);
        }
        digest.add(static_cast<std::uint32_t>(items.patch[i]));
        digest.add(items.firstBlock[i + 1]);
    }
    for (const std::uint8_t count : items.n) digest.add(std::uint32_t{count});
    for (const std::uint8_t count : items.d) digest.add(std::uint32_t{count});
    for (const CountBlock& block : items.blocks) {
        digest.add(std::uint32_t{block.key});
        for (int cell = 0; cell < kBlockCells; ++cell) {
            digest.add(std::uint32_t{block.n[static_cast<std::size_t>(cell)]});
            digest.add(std::uint32_t{block.d[static_cast<std::size_t>(cell)]});
        }
    }
    for (const std::uint16_t hit : items.hits) digest.add(std::uint32_t{hit});
    for (const std::uint16_t code : items.emitters) digest.add(std::uint32_t{code});
    return digest.value();
}

/// What a stored file must be read as.
struct Stored {
    const char* name;
    const char *bakes, *shots;
    std::size_t items, blocks, subpatches;
    unsigned visible, rays;  ///< sums of the items' coarse counts
    int format, hits;
    std::uint64_t digest;  ///< of all that the items hold
};

constexpr std::array kStored{
    Stored{"format-3", "seed=1 rays=8; seed=2 rays=8", "", 90, 696, 4, 142324, 166844, 3, 0,
           1523990672196180452u},
    Stored{"format-3-shot", "seed=1 rays=8", "camera.json, frames 1, 16x16", 41, 250, 4, 40371,
           47794, 3, 0, 76474476188052940u},
    Stored{"format-4", "seed=1 rays=8; seed=2 rays=8", "", 90, 696, 4, 119602, 143401, 4, 16,
           4383065775649796980u},
    Stored{"format-4-shot", "seed=1 rays=8", "camera.json, frames 1, 16x16, #20065d4d", 41, 190, 4,
           42340, 49385, 4, 16, 4741140696930205228u},
    Stored{"format-5", "seed=1 rays=8; seed=2 rays=8", "", 90, 696, 4, 119602, 143401, 5, 16,
           544927795145820392u},
    Stored{"format-5-shot", "seed=1 rays=8", "camera.json, frames 1, 16x16, #b12ec8f5", 41, 190, 4,
           42340, 49385, 5, 16, 8384968537471634991u}};

std::size_t sum(const std::vector<std::uint8_t>& counts) {
    return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

TEST(StoredCaches, AreReadAsTheyWereWritten) {
    for (const Stored& wanted : kStored) {
        SCOPED_TRACE(wanted.name);
        CacheHeader header;
        const CacheItems items = readCache(stored(wanted.name), header);
        EXPECT_EQ(header.format, wanted.format);
        EXPECT_EQ(header.hits, wanted.hits);
        EXPECT_EQ(items.hits.size(), wanted.items * static_cast<std::size_t>(wanted.hits));
        EXPECT_EQ(header.level, 4);
        EXPECT_TRUE(header.adaptive);
        EXPECT_EQ(header.spacing, 0.5);
        EXPECT_EQ(bakesText(header.bakes), wanted.bakes);
        EXPECT_EQ(header.upAxis, "y");
        EXPECT_EQ(header.unit, 1);
        EXPECT_EQ(fingerprintText(header.fingerprint), "b0c89e8c73662182");
        EXPECT_EQ(header.version, "0.1.0");
        EXPECT_EQ(header.part ? header.part->shots : "", wanted.shots);
        if (header.part) {
            EXPECT_EQ(header.part->sides, 38u);
            EXPECT_EQ(header.part->sidesOfSet, 86u);
        }
        EXPECT_EQ(items.size(), wanted.items);
        EXPECT_EQ(items.blocks.size(), wanted.blocks);
        std::size_t subpatches = 0;
        for (const std::int16_t patch : items.patch)
            subpatches += PatchCode::of(patch).subpatch > 0;
        EXPECT_EQ(subpatches, wanted.subpatches);
        EXPECT_EQ(sum(items.n), wanted.visible);
        EXPECT_EQ(sum(items.d), wanted.rays);
        EXPECT_EQ(digestOf(items), wanted.digest);
        EXPECT_EQ(verifyCache(stored(wanted.name)).items, wanted.items);
    }
}

// Control: the digest sees any one of the numbers.
TEST(StoredCaches, HaveADigestThatSeesOneRay) {
    CacheHeader header;
    CacheItems items = readCache(stored("format-3"), header);
    const std::uint64_t whole = digestOf(items);
    for (std::uint8_t* count : {&items.n.back(), &items.d.front(), &items.blocks.back().n.back()}) {
        ++*count;
        EXPECT_NE(digestOf(items), whole);
        --*count;
    }
    EXPECT_EQ(digestOf(items), whole);
}

/// Caches without hits have places, too.
TEST(StoredCaches, KnowTheirItemsByNumber) {
    for (const std::uint64_t budget : {std::uint64_t{0}, std::uint64_t{1} << 20})
        for (const Stored& wanted : kStored) {
            SCOPED_TRACE(wanted.name);
            const ShadowCache cache(stored(wanted.name), budget);
            const ItemTable items(cache);
            EXPECT_EQ(items.size(), wanted.items);
            for (std::uint32_t i = 0; i < items.size(); ++i) {
                if (PatchCode::of(items.item(i).patch).layer != 0) continue;
                EXPECT_EQ(items.itemAt(items.position(i), items.normal(i)), i);
            }
            const auto transport = readTransport(cache, items);
            EXPECT_EQ(transport ? transport->raysPerItem : 0, wanted.hits);
        }
}

/// On the floor beside the table and below it, all in memory and page by page.
TEST(StoredCaches, AnswerLookups) {
    for (const std::uint64_t budget : {std::uint64_t{0}, std::uint64_t{1} << 20}) {
        for (const Stored& wanted : kStored) {
            SCOPED_TRACE(wanted.name + std::string(budget ? ", paged" : ""));
            const ShadowCache cache(stored(wanted.name), budget);
            EXPECT_EQ(cache.itemCount(), wanted.items);
            EXPECT_EQ(cache.blockCount(), wanted.blocks);
            ShadowCache::Reader reader(cache);
            std::array<ItemView, ShadowCache::kMaxItems> found;
            double visible[2];
            for (const int below : {0, 1}) {
                const Vec3d place = below ? Vec3d(1.1, 0.6, 1.1) : Vec3d(0.25, 0.6, 0.25);
                const int count = reader.lookUp(place, {0, 1, 0}, found);
                ASSERT_GT(count, 0);
                double weights = 0, n = 0, d = 0;
                for (int i = 0; i < count; ++i) {
                    const ItemView& item = found[static_cast<std::size_t>(i)];
                    EXPECT_EQ(item.normal, Vec3f(0, 1, 0));
                    weights += static_cast<double>(item.weight);
                    for (std::uint32_t cell = 0; cell < cache.header().tiers().baseCells();
                         ++cell) {
                        n += item.n[cell];
                        d += item.d[cell];
                    }
                }
                EXPECT_NEAR(weights, 1, 1e-5);
                visible[below] = n / d;
            }
            EXPECT_LT(visible[1], visible[0]);
        }
    }
}

/// Each format has a file here, so that raising kCacheFormat asks for one.
TEST(StoredCaches, OfOlderFormatsAreRefusedWithWhatToDo) {
    for (int format = 1; format <= kCacheFormat; ++format) {
        const fs::path path = stored(fmt::format("format-{}", format));
        ASSERT_TRUE(fs::exists(path)) << path << ": run tests/stored/make caches";
        CacheHeader header;
        if (format >= kOldestCacheFormat) {
            EXPECT_NO_THROW(readCache(path, header));
            continue;
        }
        for (const char* part : {"this program reads", "bake the set again"}) {
            test::expectError([&] { readCache(path, header); }, path.filename().string(), part);
            test::expectError([&] { ShadowCache cache(path); }, path.filename().string(), part);
            test::expectError([&] { ShadowCache cache(path, 1 << 20); }, path.filename().string(),
                              part);
            test::expectError([&] { readHeader(path); }, path.filename().string(), part);
        }
    }
}

}  // namespace
}  // namespace shadowcache
