// What the analysis of variance finds in rays whose visibility depends on nothing, on the cell, or
// on the origin.

#include "bake/core/variance_analysis.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "common/base/hash.h"

namespace shadowcache {
namespace {

constexpr std::uint32_t kCells = 16, kOctet = 8;

/// Rays into a block: shots from `shots` origins into each of its two octets.
struct Block {
    std::array<Count, kCells> cells{};
    OriginPairs pairs;
};

/// Visibility of a ray: by cell, origin and a random number in [0, 1).
using Visibility = std::function<bool(std::uint32_t cell, double origin, double random)>;

/// @param counted  share of the rays that are counted; the others lie below a horizon
Block shoot(int shots, std::uint64_t seed, const Visibility& isVisible, double counted = 1) {
    Block block;
    for (std::uint32_t octet = 0; octet < kCells / kOctet; ++octet)
        for (int i = 0; i < shots; ++i) {
            const auto shot = static_cast<std::uint64_t>(i);
            const double origin = toUnit(hashWords(seed, octet + 2 * kCells, shot));
            std::uint32_t rays = 0, visible = 0;
            for (std::uint32_t k = octet * kOctet; k < (octet + 1) * kOctet; ++k) {
                if (toUnit(hashWords(seed, 2 * k, shot + kOctet)) >= counted) continue;
                const bool v =
                    isVisible(k, origin, toUnit(hashWords(seed, 2 * k + 1, shot + kOctet)));
                block.cells[k].word += Count::kRay + (v ? Count::kVisible : 0);
                ++rays;
                visible += v ? 1 : 0;
            }
            block.pairs += {rays * (rays - 1), visible * (visible - 1)};
        }
    return block;
}

/// Mean of the analyses of many blocks of few rays.
VarianceAnalysis meanOf(const Visibility& isVisible, double counted = 1, int shots = 3) {
    constexpr int kBlocks = 4000;
    VarianceAnalysis mean;
    for (int i = 0; i < kBlocks; ++i) {
        const Block block = shoot(shots, static_cast<std::uint64_t>(i), isVisible, counted);
        const VarianceAnalysis one = analyseVariance(block.cells, block.pairs);
        mean.mean += one.mean / kBlocks;
        mean.directions += one.directions / kBlocks;
        mean.origins += one.origins / kBlocks;
    }
    return mean;
}

// Deviations of these means are below 0.002, so 0.01 is five of them.
constexpr double kClose = 0.01;

TEST(VarianceAnalysis, OfNoiseFindsNothing) {
    const auto found = meanOf([](auto, double, double random) { return random < 0.3; });
    EXPECT_NEAR(found.mean, 0.3, kClose);
    EXPECT_NEAR(found.directions, 0, kClose);
    EXPECT_NEAR(found.origins, 0, kClose);
}

TEST(VarianceAnalysis, FindsWhatDirectionsExplain) {
    // Half of the cells see sky, which is all of the variance; then a ninth of it.
    const auto all = meanOf([](std::uint32_t cell, double, double) { return cell % 2 == 0; });
    // Pairs of different cells are one of 15 less likely to agree.
    EXPECT_NEAR(all.directions, 0.25 * 16 / 15, kClose);
    EXPECT_NEAR(all.origins, 0, 0.03);
    const auto some = meanOf([](std::uint32_t cell, double, double random) {
        return random < (cell % 2 == 0 ? 2.0 / 3 : 1.0 / 3);
    });
    EXPECT_NEAR(some.directions, 0.25 / 9 * 16 / 15, kClose);
    EXPECT_GT(some.directions, 0.015);  // control: noise is told apart
}

TEST(VarianceAnalysis, FindsWhatOriginsExplain) {
    const auto found = meanOf([](auto, double origin, double) { return origin < 0.5; });
    EXPECT_NEAR(found.origins, 0.25, kClose);
    EXPECT_NEAR(found.directions, 0, kClose);
}

// Numbers of rays that differ from cell to cell and shot to shot change no mean.
TEST(VarianceAnalysis, NeedsNoEqualNumbersOfRays) {
    const auto found = meanOf(
        [](std::uint32_t cell, double origin, double random) {
            return random < 0.25 + (cell % 2 == 0 ? 0.25 : 0) + (origin < 0.5 ? 0.25 : 0);
        },
        0.6, 4);
    EXPECT_NEAR(found.mean, 0.5, kClose);
    EXPECT_NEAR(found.directions, 0.125 * 0.125 * 16 / 15, kClose);
    EXPECT_NEAR(found.origins, 0.125 * 0.125, kClose);
}

// For equal numbers of rays: the mean squares of the classical analysis, here of one octet.
TEST(VarianceAnalysis, IsTheClassicalOneForEqualNumbers) {
    constexpr int kShots = 4;
    constexpr std::array<std::array<int, kOctet>, kShots> kSeen{{{1, 0, 1, 1, 0, 0, 1, 0},
                                                                 {1, 0, 0, 1, 0, 1, 1, 0},
                                                                 {1, 1, 1, 1, 0, 0, 1, 1},
                                                                 {0, 0, 0, 1, 0, 0, 0, 0}}};
    std::array<Count, kOctet> cells{};
    OriginPairs pairs;
    double total = 0, ofCells = 0, ofOrigins = 0;
    for (const auto& shot : kSeen) {
        std::uint32_t seen = 0;
        for (std::uint32_t k = 0; k < kOctet; ++k) {
            seen += static_cast<std::uint32_t>(shot[k]);
            cells[k].word += Count::kRay + (shot[k] ? Count::kVisible : 0);
        }
        pairs += {kOctet * (kOctet - 1), seen * (seen - 1)};
        total += seen;
        ofOrigins += static_cast<double>(seen) * seen / kOctet;
    }
    for (const Count& cell : cells)
        ofCells += static_cast<double>(cell.visible()) * cell.visible() / kShots;
    const double correction = total * total / (kShots * kOctet);
    const double rest = (total - ofCells - ofOrigins + correction) / ((kOctet - 1) * (kShots - 1));
    const double meanSquareCells = (ofCells - correction) / (kOctet - 1);
    const double meanSquareOrigins = (ofOrigins - correction) / (kShots - 1);
    const VarianceAnalysis found = analyseVariance(cells, pairs);
    EXPECT_NEAR(found.mean, total / (kShots * kOctet), 1e-12);
    EXPECT_NEAR(found.directions, (meanSquareCells - rest) / kShots, 1e-12);
    EXPECT_NEAR(found.origins, (meanSquareOrigins - rest) / kOctet, 1e-12);
}

TEST(VarianceAnalysis, GainIsTheFallOfTheDeviation) {
    EXPECT_DOUBLE_EQ((VarianceAnalysis{0.5, 0.25, 0}.gain()), 0.5);
    EXPECT_DOUBLE_EQ((VarianceAnalysis{0.5, 0.09, 0}.gain()), 0.1);
    // An estimate may lie outside of what is possible.
    EXPECT_DOUBLE_EQ((VarianceAnalysis{0.5, 0.3, 0}.gain()), 0.5);
    EXPECT_DOUBLE_EQ((VarianceAnalysis{0.5, -0.1, 0}.gain()), 0);
    EXPECT_DOUBLE_EQ((VarianceAnalysis{1, 0, 0}.gain()), 0);
}

TEST(VarianceAnalysis, OfTooFewRaysSaysNothing) {
    const Block one = shoot(1, 1, [](std::uint32_t cell, double, double) { return cell < 5; });
    EXPECT_EQ(analyseVariance(one.cells, one.pairs).gain(), 0);
    EXPECT_EQ(analyseVariance({}, {}).gain(), 0);
    // Control: with one shot more it does.
    const Block two = shoot(2, 1, [](std::uint32_t cell, double, double) { return cell < 5; });
    EXPECT_GT(analyseVariance(two.cells, two.pairs).gain(), 0.3);
}

}  // namespace
}  // namespace shadowcache
