// Solid angles down to the finest cell; Arvo's map inverts and is uniform.

#include "common/math/spherical_triangle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "common/math/direction_mesh.h"
#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

const SphericalTriangle kOctant{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// Triangle with its corners near the x axis: `width` and `height` in radians.
SphericalTriangle thinTriangle(double width, double height) {
    return {{1, 0, 0}, Vec3d(1, width, 0).normalized(), Vec3d(1, 0.3 * width, height).normalized()};
}

/// What the sampler meets: large, obtuse, tiny, slivers along either side.
std::vector<SphericalTriangle> samplingCases() {
    return {kOctant,
            cellTriangle(3, 77),
            cellTriangle(kMaxDirectionLevel, 1234567),
            {{1, 0, 0}, Vec3d(-0.9, 0.3, 0.1).normalized(), Vec3d(-0.2, -0.4, 0.9).normalized()},
            thinTriangle(0.5, 1e-6),
            thinTriangle(1e-6, 0.5),
            thinTriangle(2e-3, 1e-9)};
}

/// The 4^3 parts that three splits at the sides' midpoints make.
std::vector<SphericalTriangle> parts(const SphericalTriangle& t) {
    std::vector<SphericalTriangle> all{t};
    for (int split = 0; split < 3; ++split) {
        std::vector<SphericalTriangle> finer;
        for (const auto& [a, b, c] : all) {
            const Vec3d ab = (a + b).normalized();
            const Vec3d bc = (b + c).normalized();
            const Vec3d ca = (c + a).normalized();
            for (const SphericalTriangle& part :
                 {SphericalTriangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
                finer.push_back(part);
        }
        all = std::move(finer);
    }
    return all;
}

/// p-value that directions sampled with u0 bent by `bend` are uniform over `t`.
double areaPValue(const SphericalTriangle& t, const std::function<double(double)>& bend) {
    constexpr int kSamples = 500000;  // 64 cells then show a 3 % tilt
    const std::vector<SphericalTriangle> cells = parts(t);
    std::vector<double> observed(cells.size()), expected;
    for (const SphericalTriangle& cell : cells)
        expected.push_back(kSamples * solidAngle(cell) / solidAngle(t));
    std::mt19937_64 generator(1);
    std::uniform_real_distribution<double> uniform;
    double lost = 0.0;
    for (int i = 0; i < kSamples; ++i) {
        const double u0 = bend(uniform(generator));
        const Vec3d w = sampleDirection(t, u0, uniform(generator));
        std::size_t cell = 0;
        while (cell < cells.size() && !contains(cells[cell], w)) ++cell;
        (cell < cells.size() ? observed[cell] : lost) += 1.0;
    }
    EXPECT_EQ(lost, 0.0);
    return test::chiSquaredPValue(observed, expected);
}

TEST(SolidAngle, MatchesKnownAreas) {
    EXPECT_NEAR(solidAngle(kOctant), kPi / 2, 1e-15);
    EXPECT_NEAR(solidAngle(cellTriangle(0, 7)), kPi / 5, 1e-15);
    EXPECT_EQ(solidAngle({kOctant.a, kOctant.a, kOctant.b}), 0.0);
}

TEST(SolidAngle, KeepsItsDigitsInTheFinestCells) {
    using Vec3l = Imath::Vec3<long double>;
    for (std::uint32_t i = 0; i < cellCount(kMaxDirectionLevel); i += 10007) {
        const SphericalTriangle t = cellTriangle(kMaxDirectionLevel, i);
        const Vec3l a(t.a), b(t.b), c(t.c);
        const long double exact =
            2 * std::atan2(a.dot((b - a).cross(c - a)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
        EXPECT_NEAR(solidAngle(t) / static_cast<double>(exact), 1.0, 1e-14) << i;
    }
}

TEST(Contains, TakesSidesAndCornersAndNothingBeyond) {
    for (const SphericalTriangle& t : samplingCases()) {
        for (const Vec3d& w : {t.a, t.b, t.c, (t.a + t.b).normalized(), (t.b + t.c).normalized(),
                               (t.c + t.a).normalized(), (t.a + t.b + t.c).normalized()}) {
            EXPECT_TRUE(contains(t, w));
            EXPECT_FALSE(contains(t, -w));
        }
        // Mirrored at the opposite side's midpoint.
        EXPECT_FALSE(contains(t, (t.b + t.c - t.a).normalized()));
        EXPECT_FALSE(contains(t, (t.c + t.a - t.b).normalized()));
        EXPECT_FALSE(contains(t, (t.a + t.b - t.c).normalized()));
    }
}

TEST(ArvoSampling, StaysInsideAndUnit) {
    const std::array<double, 7> numbers{0.0, 1e-300, 1e-12, 0.3, 0.77, 1 - 1e-12, 1 - 0x1p-53};
    for (const SphericalTriangle& t : samplingCases()) {
        for (const double u0 : numbers) {
            for (const double u1 : numbers) {
                const Vec3d w = sampleDirection(t, u0, u1);
                EXPECT_TRUE(contains(t, w)) << u0 << " " << u1;
                EXPECT_NEAR(w.length(), 1.0, 1e-15);
            }
        }
    }
}

TEST(ArvoSampling, GivesAFiniteDirectionForATriangleWithoutArea) {
    const SphericalTriangle point{kOctant.a, kOctant.a, kOctant.a};
    const SphericalTriangle arc{kOctant.a, kOctant.b, kOctant.a};
    for (const SphericalTriangle& t : {point, arc})
        EXPECT_NEAR(sampleDirection(t, 0.4, 0.6).length(), 1.0, 1e-15);
}

TEST(ArvoSampling, Inverts) {
    std::mt19937_64 generator(2);
    std::uniform_real_distribution<double> uniform;
    for (const SphericalTriangle& t : samplingCases()) {
        // A direction is rounded to 1e-16: what that means for u0 grows as the triangle's least
        // height shrinks and toward the corner b.
        const double height =
            solidAngle(t) / std::sqrt(std::max({(t.b - t.a).length2(), (t.c - t.b).length2(),
                                                (t.a - t.c).length2()}));
        for (int i = 0; i < 2000; ++i) {
            const double u0 = uniform(generator);
            const double u1 = uniform(generator);
            const Imath::V2d u = invertSample(t, sampleDirection(t, u0, u1));
            EXPECT_NEAR(u.x, u0, 4e-15 / (height * std::sqrt(u1))) << u1;
            EXPECT_NEAR(u.y, u1, 4e-15 / height);
        }
    }
}

TEST(ArvoSampling, InvertsAtTheCorners) {
    const Imath::V2d atA = invertSample(kOctant, kOctant.a);
    const Imath::V2d atC = invertSample(kOctant, kOctant.c);
    EXPECT_NEAR(atA.x, 0.0, 1e-15);
    EXPECT_NEAR(atA.y, 1.0, 1e-15);
    EXPECT_NEAR(atC.x, 1.0, 1e-15);
    EXPECT_NEAR(atC.y, 1.0, 1e-15);
    EXPECT_EQ(invertSample(kOctant, kOctant.b), Imath::V2d(0, 0));
}

class ArvoUniformity : public testing::TestWithParam<std::size_t> {};

TEST_P(ArvoUniformity, HoldsInSolidAngle) {
    EXPECT_GT(areaPValue(samplingCases()[GetParam()], [](double u) { return u; }),
              test::significance(1));
}

// Control: the test above must see a 3 % tilt of the density.
TEST_P(ArvoUniformity, SeesAThreePercentTilt) {
    EXPECT_LT(
        areaPValue(samplingCases()[GetParam()], [](double u) { return u * (0.97 + 0.03 * u); }),
        test::significance(1));
}

INSTANTIATE_TEST_SUITE_P(Shapes, ArvoUniformity, testing::Range<std::size_t>(0, 7));

}  // namespace
}  // namespace shadowcache
