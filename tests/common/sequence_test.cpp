// Sobol' points have their net property; words, dimensions and seeds are uniform and
// independent.

#include "common/random/sequence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

using Words = std::vector<std::uint32_t>;

Words sobol(std::uint32_t first, std::size_t count, int dimension, std::uint64_t seed) {
    Words words(count);
    owenSobol(first, dimension, seed, words);
    return words;
}

std::uint32_t sobolWord(std::uint32_t index, int dimension, std::uint64_t seed) {
    std::uint32_t word = 0;
    owenSobol(index, dimension, seed, {&word, 1});
    return word;
}

/// Whether every box of 2^-k by 2^-(m - t - k) holds exactly 2^t of the 2^m points (x, y), for all
/// k.
bool isNet(const Words& x, const Words& y, unsigned m, unsigned t) {
    const unsigned bits = m - t;
    for (unsigned k = 0; k <= bits; ++k) {
        std::vector<unsigned> counts(std::size_t{1} << bits);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const std::uint64_t column = (std::uint64_t{x[i]} << k) >> 32;
            const std::uint64_t row = (std::uint64_t{y[i]} << (bits - k)) >> 32;
            ++counts[(column << (bits - k)) | row];
        }
        for (const unsigned count : counts)
            if (count != 1u << t) return false;
    }
    return true;
}

/// p-value that `draw(seed)` in 0 .. 63 is uniform over half a million seeds.
template <class Draw>
double uniformityPValue(Draw draw) {
    constexpr std::uint64_t kSeeds = 500000;
    std::vector<double> observed(64), expected(64, kSeeds / 64.0);
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) observed[draw(seed)] += 1.0;
    return test::chiSquaredPValue(observed, expected);
}

std::size_t pairCell(std::uint32_t a, std::uint32_t b) {
    return (a >> 29) * 8 + (b >> 29);
}

TEST(OwenSobol, TheFirstTwoDimensionsAreAZeroTwoSequence) {
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        for (unsigned m = 0; m <= 10; ++m) {
            const std::uint32_t count = 1u << m;
            for (const std::uint32_t block : {0u, 1u, 5u, (1u << (31 - m))})
                EXPECT_TRUE(isNet(sobol(block * count, count, 0, seed),
                                  sobol(block * count, count, 1, seed), m, 0))
                    << seed << " " << m << " " << block;
        }
    }
}

// t is at most the sum of the primitive polynomials' degrees less one each. [Sobol' 1967]
TEST(OwenSobol, TheOtherPairsAreNetsOfTheirQuality) {
    struct Pair {
        int a, b;
        unsigned t;
    };
    for (const Pair& pair :
         {Pair{0, 2, 1}, Pair{1, 2, 1}, Pair{0, 3, 2}, Pair{1, 3, 2}, Pair{2, 3, 3}})
        for (std::uint64_t seed = 0; seed < 8; ++seed)
            for (unsigned m = pair.t; m <= 10; ++m)
                EXPECT_TRUE(isNet(sobol(0, std::size_t{1} << m, pair.a, seed),
                                  sobol(0, std::size_t{1} << m, pair.b, seed), m, pair.t))
                    << pair.a << " " << pair.b << " " << m;
}

TEST(OwenSobol, EveryDimensionIsStratified) {
    for (int dimension = 0; dimension < kSobolDimensions; ++dimension) {
        std::set<std::uint32_t> strata;
        for (const std::uint32_t word : sobol(3 * 4096, 4096, dimension, 99))
            strata.insert(word >> 20);
        EXPECT_EQ(strata.size(), 4096u);
    }
}

// Control: points that are merely random, or of two seeds, are no net.
TEST(OwenSobol, TheNetTestSeesRandomAndForeignPoints) {
    std::mt19937 generator(1);
    Words random(64);
    for (std::uint32_t& word : random) word = static_cast<std::uint32_t>(generator());
    EXPECT_FALSE(isNet(sobol(0, 64, 0, 1), random, 6, 0));
    EXPECT_FALSE(isNet(sobol(0, 64, 0, 1), sobol(0, 64, 1, 2), 6, 0));
}

TEST(OwenSobol, ARangeIsAPartOfTheWhole) {
    const Words whole = sobol(0, 500, 2, 7);
    for (const std::uint32_t first : {0u, 1u, 63u, 64u, 65u, 200u})
        for (const std::size_t count : {0u, 1u, 3u, 64u, 65u, 130u, 300u})
            EXPECT_EQ(
                sobol(first, count, 2, 7),
                Words(whole.begin() + first, whole.begin() + first + static_cast<long>(count)));
}

TEST(OwenSobol, EveryWordIsUniformOverTheSeeds) {
    for (int dimension = 0; dimension < kSobolDimensions; ++dimension)
        EXPECT_GT(uniformityPValue(
                      [&](std::uint64_t seed) { return sobolWord(37, dimension, seed) >> 26; }),
                  test::significance(kSobolDimensions))
            << dimension;
}

// Control: the test above must see a 3 % tilt of the density.
TEST(OwenSobol, TheUniformityTestSeesAThreePercentTilt) {
    EXPECT_LT(uniformityPValue([](std::uint64_t seed) {
                  const double u = sobolWord(37, 0, seed) * 0x1p-32;
                  return static_cast<std::size_t>(64.0 * u * (0.97 + 0.03 * u));
              }),
              test::significance(kSobolDimensions));
}

TEST(OwenSobol, DimensionsOfOnePointAreIndependent) {
    for (const auto& [a, b] : {std::pair{0, 1}, std::pair{1, 2}, std::pair{2, 3}})
        EXPECT_GT(uniformityPValue([a = a, b = b](std::uint64_t seed) {
                      return pairCell(sobolWord(5, a, seed), sobolWord(5, b, seed));
                  }),
                  test::significance(3));
}

TEST(OwenSobol, NeighbouringSeedsAreIndependent) {
    for (int dimension = 0; dimension < kSobolDimensions; ++dimension)
        EXPECT_GT(uniformityPValue([&](std::uint64_t seed) {
                      return pairCell(sobolWord(11, dimension, 2 * seed),
                                      sobolWord(11, dimension, 2 * seed + 1));
                  }),
                  test::significance(kSobolDimensions));
}

// Owen's law for two points that part at the first bit: all later bits are independent.
TEST(OwenSobol, PointsThatPartAreIndependentBelow) {
    EXPECT_GT(uniformityPValue([](std::uint64_t seed) {
                  return pairCell(sobolWord(0, 0, seed) << 1, sobolWord(1, 0, seed) << 1);
              }),
              test::significance(1));
}

// Control: with the bit where they part the two points depend on each other.
TEST(OwenSobol, TheIndependenceTestSeesTheFirstBit) {
    EXPECT_LT(uniformityPValue([](std::uint64_t seed) {
                  return pairCell(sobolWord(0, 0, seed), sobolWord(1, 0, seed));
              }),
              test::significance(1));
}

double correlation(const Words& a, const Words& b) {
    double ab = 0.0, aa = 0.0, bb = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double x = a[i] * 0x1p-32 - 0.5;
        const double y = b[i] * 0x1p-32 - 0.5;
        ab += x * y, aa += x * x, bb += y * y;
    }
    return ab / std::sqrt(aa * bb);
}

// One dimension under two seeds is a pair like any other only because the index is shuffled:
// without that the mean square would be above 1/2. The shuffle mixes within pairs, hence 2 / N and
// not 1 / N.
TEST(OwenSobol, SeedsPairPointsAtRandom) {
    constexpr std::size_t kPoints = 64;
    for (int dimension = 0; dimension < kSobolDimensions; ++dimension) {
        std::vector<double> correlations;
        double squares = 0.0;
        for (std::uint64_t seed = 0; seed < 4000; ++seed) {
            correlations.push_back(correlation(sobol(0, kPoints, dimension, 2 * seed),
                                               sobol(0, kPoints, dimension, 2 * seed + 1)));
            squares += correlations.back() * correlations.back() / 4000.0;
        }
        EXPECT_GT(test::meanPValue(correlations, 0.0), test::significance(kSobolDimensions));
        EXPECT_LT(squares, 2.5 / kPoints);
        // Control: a correlation of 2 % is seen.
        for (double& c : correlations) c += 0.02;
        EXPECT_LT(test::meanPValue(correlations, 0.0), test::significance(kSobolDimensions));
    }
}

TEST(Hash, UnitNumbersStayBelowOne) {
    EXPECT_EQ(toUnit(0), 0.0);
    EXPECT_LT(toUnit(~0ull), 1.0);
    EXPECT_LT(toUnitFloat(~0u), 1.0f);
}

}  // namespace
}  // namespace shadowcache
