// The linear density over a spherical triangle: what it draws, and the shape that it takes.

#include "tests/study/estimators/linear_triangle.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "common/math/direction_mesh.h"
#include "tests/support/statistics.h"

namespace shadowcache::study {
namespace {

const std::array<double, 3> kValues{0.1, 2.5, 0.4};

constexpr int kFiner = 3;  ///< levels by which a cell is divided to count in its parts

/// Integral of the density over `t`, by uniform directions.
double integral(const LinearTriangle& linear, const SphericalTriangle& t) {
    constexpr int kSide = 16;
    double sum = 0;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            sum += linear.density(sampleDirection(t, (x + 0.5) / kSide, (y + 0.5) / kSide));
    return sum / (kSide * kSide) * solidAngle(t);
}

/// Integrals over the parts of a cell of the direction mesh.
std::vector<double> integrals(const LinearTriangle& linear, int level, std::uint32_t cell) {
    std::vector<double> all;
    for (std::uint32_t k = 0; k < 1u << (2 * kFiner); ++k)
        all.push_back(integral(linear, cellTriangle(level + kFiner, (cell << (2 * kFiner)) + k)));
    return all;
}

/// p-value that the samples of one density over a cell follow another.
double samplingPValue(int level, std::uint32_t cell, const std::array<double, 3>& drawn,
                      const std::array<double, 3>& said) {
    constexpr int kSamples = 400000;
    const LinearTriangle source(cellTriangle(level, cell), drawn);
    std::vector<double> expected =
        integrals(LinearTriangle(cellTriangle(level, cell), said), level, cell);
    for (double& e : expected) e *= kSamples;
    std::vector<double> observed(expected.size());
    std::mt19937_64 generator(1);
    std::uniform_real_distribution<double> uniform;
    for (int i = 0; i < kSamples; ++i) {
        const double u = uniform(generator);
        const Vec3d w = source.sample(u, uniform(generator));
        const std::uint32_t part = locateCell(level + kFiner, w) - (cell << (2 * kFiner));
        if (part < observed.size()) observed[part] += 1;
    }
    return test::chiSquaredPValue(observed, expected);
}

TEST(LinearTriangle, DensityHasUnitIntegral) {
    for (const int level : {0, 3, kMaxDirectionLevel - kFiner}) {
        const auto parts = integrals(LinearTriangle(cellTriangle(level, 11), kValues), level, 11);
        EXPECT_NEAR(std::accumulate(parts.begin(), parts.end(), 0.0), 1, 1e-3) << level;
    }
}

// Control: a corner value that differs by 5 % of the mean is rejected.
TEST(LinearTriangle, DrawsFromItsDensity) {
    for (const int level : {0, 4}) {
        const double limit = test::significance(2);
        EXPECT_GT(samplingPValue(level, 7, kValues, kValues), limit) << level;
        EXPECT_LT(samplingPValue(level, 7, kValues, {0.1, 2.5, 0.45}), limit) << level;
    }
}

// Luminance that is linear over the triangle is found again; a lamp in a corner has at most what
// the floor elsewhere leaves it.
TEST(LinearTriangle, ShapeIsThatOfTheLight) {
    const SphericalTriangle t = cellTriangle(5, 100);
    const LinearTriangle light(t, {0.5, 2, 0.5});
    constexpr int kSide = 300;
    Vec3d firstMoment(0, 0, 0);
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const Vec3d w = sampleDirection(t, (x + 0.5) / kSide, (y + 0.5) / kSide);
            firstMoment += w * light.density(w);
        }
    const auto shape = linearShape(t, firstMoment);
    EXPECT_NEAR(shape[0], 0.5, 0.01);
    EXPECT_NEAR(shape[1], 2, 0.02);
    EXPECT_NEAR(shape[2], 0.5, 0.01);
    const auto lamp = linearShape(t, t.b);
    EXPECT_GT(lamp[1], 2.9);
    for (const double value : lamp) EXPECT_GE(value, 0.03);
}

}  // namespace
}  // namespace shadowcache::study
