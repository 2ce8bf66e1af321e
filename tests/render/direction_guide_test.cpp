// Directions of guided rays have the density that is said of them.

#include "render/bounces/direction_guide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "common/random/sequence.h"
#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

constexpr int kRows = 16,
              kColumns = 24;  // of cells over the upper hemisphere, alike in solid angle
constexpr int kDraws = 400'000;
const Vec3f kNormal(0, 0, 1);

/// A near ball, a far one that it overlaps, one at the horizon, and one around the place.
DirectionGuide guide() {
    return {{{{{1, 0, 2}, 0.6f}, 0.4f},
             {{{6, 0, 11}, 1.0f}, 0.3f},
             {{{0, 3, 0.1f}, 0.5f}, 0.2f},
             {{{0, 0, 0.2f}, 0.5f}, 0.1f}},
            0.5f};
}

/// How many of kDraws directions fall into each cell, and below the horizon, the last.
std::vector<double> countDraws(const DirectionGuide& guide) {
    std::vector<double> counts(kRows * kColumns + 1);
    for (std::uint64_t i = 0; i < kDraws; ++i) {
        const Vec3d d(guide
                          .draw(Vec3f(0), kNormal,
                                {toUnitFloat(static_cast<std::uint32_t>(hashWords(i))),
                                 toUnitFloat(static_cast<std::uint32_t>(hashWords(i, 1)))})
                          .direction);
        const auto row = static_cast<int>(d.z * kRows);
        const auto column = static_cast<int>((std::atan2(d.y, d.x) / (2 * kPi) + 0.5) * kColumns);
        const std::size_t cell =
            d.z < 0 ? counts.size() - 1
                    : static_cast<std::size_t>(std::min(row, kRows - 1) * kColumns +
                                               std::min(column, kColumns - 1));
        counts[cell] += 1;
    }
    return counts;
}

/// What the density says of them.
std::vector<double> expectDraws(const DirectionGuide& guide) {
    constexpr int kFine = 60;  // points along each side of a cell
    std::vector<double> expected(kRows * kColumns + 1);
    double above = 0;
    for (int r = 0; r < kRows * kFine; ++r)
        for (int c = 0; c < kColumns * kFine; ++c) {
            const double z = (r + 0.5) / (kRows * kFine), s = std::sqrt(1 - z * z);
            const double phi = 2 * kPi * ((c + 0.5) / (kColumns * kFine) - 0.5);
            const Vec3f d(Vec3d(s * std::cos(phi), s * std::sin(phi), z));
            const double part = static_cast<double>(guide.density(Vec3f(0), d.z, d)) / kPi * 2 *
                                kPi / (kRows * kFine * kColumns * kFine) * kDraws;
            expected[static_cast<std::size_t>(r / kFine * kColumns + c / kFine)] += part;
            above += part;
        }
    expected.back() = kDraws - above;
    return expected;
}

TEST(DirectionGuide, DrawsByItsDensity) {
    const std::vector<double> expected = expectDraws(guide());
    EXPECT_GT(test::chiSquaredPValue(countDraws(guide()), expected), test::significance(1));
    EXPECT_LT(test::chiSquaredPValue(countDraws(DirectionGuide()), expected),
              test::significance(1));
}

// The cosine over a cone that is hardly wider than that of a far ball, by draws: rays at the edge
// of the ball's cone, which rounding may put beside it, have a large weight if they count as the
// cosine's.
TEST(DirectionGuide, IsRightForFarBalls) {
    const Vec3f axis = Vec3f(0, 300, 500).normalized();
    const DirectionGuide far({{{axis * 600, 1.0f}, 0.5f}, {{{-70, 0, 90}, 0.1f}, 0.5f}}, 0.5f);
    constexpr double kSine = 0.02005;
    std::vector<double> found(100);
    constexpr std::uint64_t kEach = 20'000;
    for (std::uint64_t i = 0; i < found.size() * kEach; ++i) {
        const auto [d, part] = far.draw(Vec3f(0), kNormal,
                                        {toUnitFloat(static_cast<std::uint32_t>(hashWords(i, 2))),
                                         toUnitFloat(static_cast<std::uint32_t>(hashWords(i, 3)))});
        if (Vec3d(d).cross(Vec3d(axis)).length() > kSine || d.dot(axis) < 0) continue;
        found[i / kEach] += static_cast<double>(d.z / far.density(Vec3f(0), d.z, d, part)) / kEach;
    }
    const double truth = kSine * kSine * static_cast<double>(axis.z);  // over pi
    EXPECT_GT(test::meanPValue(found, truth), test::significance(1));
    EXPECT_LT(test::meanPValue(found, 1.03 * truth), test::significance(1)) << "3 % are not seen";
}

TEST(DirectionGuide, WithoutBallsIsByTheCosine) {
    const DirectionGuide cosine;
    EXPECT_TRUE(cosine.isCosine());
    EXPECT_EQ(cosine.density(Vec3f(0), 0.25f, Vec3f(0, 0, 1)), 0.25f);
}

}  // namespace
}  // namespace shadowcache
