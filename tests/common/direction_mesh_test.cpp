// Cells tile the sphere at every level; location agrees with geometry; numbering is that of the
// file format.

#include "common/math/direction_mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "common/base/parallel.h"
#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

/// Calls `visit` for all cells of a coarse level, for a spread of a fine one's.
template <class Visit>
void forCells(int level, Visit visit) {
    const std::uint32_t stride = level <= 5 ? 1 : 997;
    for (std::uint32_t cell = 0; cell < cellCount(level); cell += stride) visit(cell);
}

std::vector<Vec3d> randomDirections(std::size_t count) {
    std::mt19937_64 generator(1);
    std::normal_distribution<double> normal;
    std::vector<Vec3d> directions(count);
    for (Vec3d& w : directions)
        w = Vec3d(normal(generator), normal(generator), normal(generator)).normalized();
    return directions;
}

/// `contains` for a direction on a border that the neighbour claims by one rounding.
bool touches(const SphericalTriangle& t, const Vec3d& w) {
    const Vec3d inward = (t.a + t.b + t.c) * 1e-15;
    return contains(t, w) || contains(t, (w + inward).normalized());
}

TEST(DirectionMesh, AreasSumToTheSphereAtEveryLevel) {
    for (int level = 0; level <= kMaxDirectionLevel; ++level) {
        const double sum = parallelSum(cellCount(level), 4096, [&](const Chunk& chunk) {
            double part = 0.0;
            for (std::size_t cell = chunk.begin; cell < chunk.end; ++cell)
                part += solidAngle(cellTriangle(level, static_cast<std::uint32_t>(cell)));
            return part;
        });
        EXPECT_NEAR(sum, 4 * kPi, 1e-11) << level;
    }
}

TEST(DirectionMesh, CellsAreCounterClockwiseAndAlikeInSize) {
    for (int level = 0; level <= kMaxDirectionLevel; ++level) {
        const double mean = 4 * kPi / cellCount(level);
        forCells(level, [&](std::uint32_t cell) {
            const SphericalTriangle t = cellTriangle(level, cell);
            EXPECT_GT(t.a.dot((t.b - t.a).cross(t.c - t.a)), 0.0);
            EXPECT_NEAR(solidAngle(t) / mean, 1.0, 0.4);
            for (const Vec3d& corner : {t.a, t.b, t.c}) EXPECT_NEAR(corner.length(), 1.0, 1e-15);
        });
    }
}

TEST(DirectionMesh, ChildrenFillTheirParent) {
    for (int level = 0; level < kMaxDirectionLevel; ++level) {
        forCells(level, [&](std::uint32_t cell) {
            const SphericalTriangle parent = cellTriangle(level, cell);
            double sum = 0.0;
            for (std::uint32_t child = 4 * cell; child < 4 * cell + 4; ++child) {
                EXPECT_EQ(ancestorCell(child, level + 1, level), cell);
                EXPECT_TRUE(contains(parent, cellCenter(level + 1, child)));
                sum += solidAngle(cellTriangle(level + 1, child));
            }
            EXPECT_NEAR(sum / solidAngle(parent), 1.0, 1e-12);
        });
    }
}

TEST(DirectionMesh, ChildrenMeetAtTheMidpointsOfTheSides) {
    for (const int level : {0, 4, 5, 8}) {
        const std::uint32_t cell = cellCount(level) / 3;
        const SphericalTriangle t = cellTriangle(level, cell);
        const SphericalTriangle middle = cellTriangle(level + 1, 4 * cell + 3);
        EXPECT_EQ(middle.a, (t.a + t.b).normalized());
        EXPECT_EQ(middle.b, (t.b + t.c).normalized());
        EXPECT_EQ(middle.c, (t.c + t.a).normalized());
        EXPECT_EQ(cellTriangle(level + 1, 4 * cell).a, t.a);
        EXPECT_EQ(cellTriangle(level + 1, 4 * cell + 1).b, t.b);
        EXPECT_EQ(cellTriangle(level + 1, 4 * cell + 2).c, t.c);
    }
}

TEST(LocateCell, FindsEveryCentre) {
    for (int level = 0; level <= kMaxDirectionLevel; ++level)
        forCells(level, [&](std::uint32_t cell) {
            EXPECT_EQ(locateCell(level, cellCenter(level, cell)), cell);
        });
}

TEST(LocateCell, FindsTheCellThatHoldsTheDirection) {
    for (const Vec3d& w : randomDirections(20000)) {
        const std::uint32_t finest = locateCell(kMaxDirectionLevel, w);
        for (int level = 0; level <= kMaxDirectionLevel; ++level) {
            const std::uint32_t cell = locateCell(level, w);
            EXPECT_TRUE(touches(cellTriangle(level, cell), w));
            EXPECT_EQ(ancestorCell(finest, kMaxDirectionLevel, level), cell);
        }
    }
}

TEST(LocateCell, GivesANeighbourOnBorders) {
    for (int level = 0; level <= kMaxDirectionLevel; ++level) {
        forCells(level, [&](std::uint32_t cell) {
            const SphericalTriangle t = cellTriangle(level, cell);
            for (const Vec3d& w : {t.a, t.b, t.c, (t.a + t.b).normalized(),
                                   (t.b + t.c).normalized(), (t.c + t.a).normalized()})
                EXPECT_TRUE(touches(cellTriangle(level, locateCell(level, w)), w)) << level;
        });
    }
}

TEST(LocateCell, AlwaysAnswersWithACell) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<Vec3d> hostile{Vec3d(0.0), Vec3d(nan), Vec3d(1e-310, 0, 1), Vec3d(-0.0, 0.0, -1)};
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
            hostile.emplace_back(0.0);
            hostile.back()[axis] = sign;
        }
    }
    for (const Vec3d& w : hostile)
        for (int level = 0; level <= kMaxDirectionLevel; ++level)
            EXPECT_LT(locateCell(level, w), cellCount(level));
}

// Directions come from floats: a length off by 1e-6 must not change the cell away from borders.
TEST(LocateCell, DoesNotMindTheLength) {
    for (const Vec3d& w : randomDirections(5000))
        EXPECT_EQ(locateCell(6, w), locateCell(6, w * (1 + 1e-6)));
}

// The order and orientation of the cells are part of the cache's format; these values never change.
TEST(DirectionMesh, KeepsItsFormat) {
    const double phi = (1 + std::sqrt(5.0)) / 2;
    const SphericalTriangle first = cellTriangle(0, 0);
    EXPECT_LT((first.a - Vec3d(1, phi, 0).normalized()).length(), 1e-15);
    EXPECT_LT((first.b - Vec3d(0, 1, phi).normalized()).length(), 1e-15);
    EXPECT_LT((first.c - Vec3d(phi, 0, 1).normalized()).length(), 1e-15);
    const std::array<Vec3d, 4> directions{Vec3d(0.36, 0.48, 0.8), Vec3d(-0.48, 0.8, -0.36),
                                          Vec3d(0.8, -0.36, -0.48), Vec3d(-0.48, -0.8, 0.36)};
    const std::array<std::uint32_t, 4> cells{1732, 20962, 14553, 25058};
    for (std::size_t i = 0; i < directions.size(); ++i)
        EXPECT_EQ(locateCell(6, directions[i]), cells[i]);
}

/// p-value that directions uniform over the sphere, their heights bent by `tilt`, fall into the
/// cells of level 1 by area.
double cellsPValue(double tilt) {
    constexpr int kLevel = 1;
    constexpr int kSamples = 500000;
    std::vector<double> observed(cellCount(kLevel)), expected;
    for (std::uint32_t cell = 0; cell < cellCount(kLevel); ++cell)
        expected.push_back(kSamples * solidAngle(cellTriangle(kLevel, cell)) / (4 * kPi));
    std::mt19937_64 generator(3);
    std::uniform_real_distribution<double> uniform;
    for (int i = 0; i < kSamples; ++i) {
        const double u = uniform(generator);
        const double z = 2 * u * (1 - tilt + tilt * u) - 1;
        const double longitude = 2 * kPi * uniform(generator);
        const double radius = std::sqrt(1 - z * z);
        const Vec3d w(radius * std::cos(longitude), radius * std::sin(longitude), z);
        observed[locateCell(kLevel, w)] += 1;
    }
    return test::chiSquaredPValue(observed, expected);
}

TEST(LocateCell, CountsUniformDirectionsByArea) {
    EXPECT_GT(cellsPValue(0.0), test::significance(1));
}

// Control: the test above must see a 3 % tilt of the density.
TEST(LocateCell, SeesAThreePercentTilt) {
    EXPECT_LT(cellsPValue(0.03), test::significance(1));
}

}  // namespace
}  // namespace shadowcache
