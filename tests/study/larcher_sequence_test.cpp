// Larcher's sequences are nets, and their words are uniform over the seeds.

#include "tests/study/estimators/larcher_sequence.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

#include "tests/support/statistics.h"

namespace shadowcache::study {
namespace {

/// Whether 2^m points fall one into each box of every shape of 2^-m.
bool isNet(int m, Sequence sequence, std::uint32_t spoil = 0) {
    const std::size_t count = std::size_t{1} << m;
    std::vector<std::uint32_t> x(count), y(count);
    sequence.fill(0, 0, 5, x);
    sequence.fill(0, 1, 5, y);
    y[count / 2] += spoil;
    for (int split = 0; split <= m; ++split) {
        std::set<std::uint64_t> boxes;
        for (std::size_t i = 0; i < count; ++i)
            boxes.insert((std::uint64_t{x[i]} << split >> 32) << 32 |
                         (std::uint64_t{y[i]} << (m - split) >> 32));
        if (boxes.size() != count) return false;
    }
    return true;
}

// XOR keeps boxes whole; a shift does not, but keeps the strata of one axis. Control: one moved
// point is seen.
TEST(LarcherPillichshammer, MakesNetsWithItsIndex) {
    for (const int m : {1, 4, 7, 10}) {
        EXPECT_TRUE(isNet(m, larcherXor(1u << m))) << m;
        EXPECT_FALSE(isNet(m, larcherXor(1u << m), 0x80000000u)) << m;
        EXPECT_FALSE(m > 1 && isNet(m, Sequence::kRandom)) << m;
    }
    EXPECT_EQ(larcherPillichshammer(1), 0x80000000u);
    EXPECT_EQ(larcherPillichshammer(2), 0xc0000000u);
    EXPECT_EQ(larcherPillichshammer(3), 0x40000000u);
    EXPECT_EQ(larcherPillichshammer(4), 0xe0000000u);
}

// Every word alone is uniform over the seeds. Control: without the random word it is not.
TEST(LarcherPillichshammer, WordsAreUniformOverSeeds) {
    constexpr int kSeeds = 20000, kBins = 64;
    for (const Sequence sequence : {larcherXor(165), larcherShift(165)})
        for (const int dimension : {0, 1, 2, 3}) {
            std::vector<double> counts(kBins), fixed(kBins);
            for (int seed = 0; seed < kSeeds; ++seed) {
                std::array<std::uint32_t, 165> words{};
                sequence.fill(0, dimension, static_cast<std::uint64_t>(seed), words);
                counts[words[91] * std::uint64_t{kBins} >> 32] += 1;
                fixed[larcherPillichshammer(91) * std::uint64_t{kBins} >> 32] += 1;
            }
            const std::vector<double> expected(kBins, static_cast<double>(kSeeds) / kBins);
            EXPECT_GT(test::chiSquaredPValue(counts, expected), test::significance(8));
            EXPECT_LT(test::chiSquaredPValue(fixed, expected), test::significance(8));
        }
}

}  // namespace
}  // namespace shadowcache::study
