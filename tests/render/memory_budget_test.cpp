// Caches larger than the memory they are given: the same pictures.

#include <gtest/gtest.h>

#include <optional>

#include "render/frame/aov_channels.h"
#include "tests/support/plain_set.h"

namespace shadowcache::test {
namespace {

void expectSameFilm(const Film& a, const Film& b) {
    const auto& aovs = aovNames();
    const auto one = channels(a, aovs), two = channels(b, aovs);
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t c = 0; c < one.size(); ++c)
        EXPECT_TRUE(one[c].values == two[c].values) << one[c].name;
}

TEST(MemoryBudget, RendersTheSamePictureOfACacheTenTimesItsSize) {
    constexpr std::uint64_t kBudget = 17 << 20;
    BakeOptions options;
    options.spacing = 0.024;
    options.level = 4;
    options.rays = 1;
    options.adaptive = false;
    const TemporaryFolder folder;
    const auto path = writePlain(folder, options);
    std::optional<Film> whole, preview;
    std::size_t items = 0, blocks = 0;
    {
        const ShadowCache cache(path);
        EXPECT_GT(cache.memoryBytes(), 10 * kBudget);
        items = cache.itemCount();
        blocks = cache.blockCount();
        whole = renderPlain(cache, 0);
        preview = renderPlain(cache, 0, 0);
    }
    for (const int threads : {1, 0}) {
        const ShadowCache cache(path, kBudget);
        EXPECT_EQ(cache.itemCount(), items);
        EXPECT_EQ(cache.blockCount(), blocks);
        expectSameFilm(renderPlain(cache, threads), *whole);
        expectSameFilm(renderPlain(cache, threads, 0), *preview);
        const MemoryUse use = cache.memoryUse();
        EXPECT_GT(use.loads, 0u);
        EXPECT_GT(use.drops, 0u);
        // More threads look at more places at one time.
        if (threads == 1) {
            EXPECT_LE(use.peak, kBudget);
        }
        EXPECT_LE(use.held, use.peak);
        EXPECT_EQ(cache.memoryBytes(), use.held);
    }
    // Control: with room for all of it nothing is dropped, and nothing read twice.
    const ShadowCache roomy(path, 100 * kBudget);
    expectSameFilm(renderPlain(roomy, 0), *whole);
    EXPECT_EQ(roomy.memoryUse().drops, 0u);
    EXPECT_LT(roomy.memoryUse().bytesRead, std::filesystem::file_size(path));
}

}  // namespace
}  // namespace shadowcache::test
