// Pages of a file under a budget of memory.

#include "common/cache/budgeted_pages.h"

#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <numeric>
#include <vector>

#include "common/base/parallel.h"
#include "common/random/sequence.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

using test::TemporaryFolder;

constexpr std::uint32_t kPage = 1000, kPages = 40;

/// A file of plain pages with checksums; each byte of a page is its number.
class Pages : public testing::Test {
protected:
    Pages() {
        // OpenVDB's header would be in the first page, and its identifier is set there.
        std::string bytes(kPage, '\0');
        for (std::uint32_t p = 0; p < kPages; ++p) {
            table_.push_back({bytes.size(), kPage, kPage, FilePage::Kind::plain});
            bytes.append(kPage, static_cast<char>(p));
        }
        path_ = folder_.path() / "pages.vdb";
        AtomicFile file(path_);
        file.write(bytes.data(), bytes.size());
        sealFile(file);
        file.commit();
        empty_ = BudgetedPages(open(), table_, 1, 0).use().held;
    }

    CheckedFile open() const { return CheckedFile::open(path_).value(); }

    static void expectPage(const PagePin& pin, std::uint32_t page) {
        for (std::uint32_t i = 0; i < kPage; ++i)
            ASSERT_EQ(static_cast<std::uint32_t>(pin[i]), page) << i;
    }

    TemporaryFolder folder_;
    std::filesystem::path path_;
    std::vector<FilePage> table_;
    std::uint64_t empty_ = 0;  ///< bytes held without any page
};

TEST_F(Pages, KeepsThoseUsedLast) {
    // Room for five, of which one is read into twice its size.
    BudgetedPages pages(open(), table_, empty_ + 6 * kPage, 0);
    for (const std::uint32_t p : {0u, 1u, 2u, 3u, 4u, 0u}) expectPage(pages.pin(p), p);
    EXPECT_EQ(pages.use().loads, 5u);
    EXPECT_EQ(pages.use().drops, 0u);
    pages.pin(5);  // in place of 1, the oldest
    EXPECT_EQ(pages.use().drops, 1u);
    const std::uint64_t before = pages.use().loads;
    for (const std::uint32_t p : {0u, 2u, 3u, 4u, 5u}) expectPage(pages.pin(p), p);
    EXPECT_EQ(pages.use().loads, before);
    pages.pin(1);
    EXPECT_EQ(pages.use().loads, before + 1);
    EXPECT_EQ(pages.use().peak, empty_ + 6 * kPage);
}

TEST_F(Pages, DropsNothingThatIsHeld) {
    BudgetedPages pages(open(), table_, 1, 0);
    std::vector<PagePin> pins;
    for (std::uint32_t p = 0; p < 10; ++p) pins.push_back(pages.pin(p));
    EXPECT_EQ(pages.use().drops, 0u);
    EXPECT_EQ(pages.use().held, empty_ + 10 * kPage);
    for (std::uint32_t p = 0; p < 10; ++p) expectPage(pins[p], p);
    pins.clear();
    pages.pin(20);
    EXPECT_EQ(pages.use().drops, 10u);
    EXPECT_EQ(pages.use().held, empty_ + kPage);
}

TEST_F(Pages, AreHeldTogetherOrNotAtAll) {
    BudgetedPages pages(open(), table_, empty_ + 20 * kPage, 0);
    pages.pin(1);
    pages.pin(2);
    std::array<PagePin, 3> pins;
    const std::array<std::uint32_t, 3> wanted{1, 2, 3};
    EXPECT_FALSE(pages.pinHeld(wanted, pins));
    EXPECT_EQ(pins[0], nullptr);
    pages.pin(3);
    EXPECT_TRUE(pages.pinHeld(wanted, pins));
    for (std::size_t i = 0; i < 3; ++i) expectPage(pins[i], wanted[i]);
}

TEST_F(Pages, ServeManyThreads) {
    const std::uint64_t budget = empty_ + 12 * kPage;
    BudgetedPages pages(open(), table_, budget, 0);
    parallelFor(4000, 20, [&](const Chunk& chunk) {
        PagePin last;
        std::uint32_t lastPage = 0;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const auto page = static_cast<std::uint32_t>(hashWords(1, i) % kPages);
            PagePin pin = pages.pin(page);
            expectPage(pin, page);
            if (last) expectPage(last, lastPage);
            last = std::move(pin);
            lastPage = page;
        }
    });
    const MemoryUse use = pages.use();
    EXPECT_GT(use.drops, 1000u);
    EXPECT_EQ(use.bytesRead, use.loads * kPage);
    EXPECT_EQ(use.held, empty_ + (use.loads - use.drops) * kPage);
    // Each thread holds two and reads one into twice its size.
    if (threadCount() <= 3) {
        EXPECT_LE(use.peak, budget);
    }
}

TEST_F(Pages, OfAFileCutShortSayWhichFile) {
    BudgetedPages pages(open(), table_, empty_ + 20 * kPage, 0);
    pages.pin(0);
    // Page 14 lies in the first piece that has a checksum, page 20 in the next.
    std::filesystem::resize_file(path_, kChecksumBytes + 10);
    pages.pin(14);
    const std::uint64_t before = pages.use().held;
    for (int turn = 0; turn < 2; ++turn)
        test::expectError([&] { pages.pin(20); }, "pages.vdb", "cut short while it was in use");
    EXPECT_EQ(pages.use().held, before);
    expectPage(pages.pin(0), 0);
}

TEST_F(Pages, ThatAreDamagedSayWhichFile) {
    for (const auto kind : {FilePage::Kind::blosc, FilePage::Kind::voxelEnds}) {
        auto table = table_;
        table[3] = {4 * kPage, kPage, 2048, kind};
        BudgetedPages pages(open(), table, 1, 0);
        test::expectError([&] { pages.pin(3); }, "pages.vdb", "damaged");
    }
}

TEST_F(Pages, ThatDifferFromTheirChecksumsAreNotHandedOut) {
    {
        std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
        file.seekp(21 * kPage);
        file.put('!');
    }
    BudgetedPages pages(open(), table_, 1, 0);
    expectPage(pages.pin(2), 2);
    test::expectError([&] { pages.pin(20); }, "pages.vdb", "differ from their checksum");
}

}  // namespace
}  // namespace shadowcache
