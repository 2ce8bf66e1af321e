// Clipping to the hemisphere partitions; vector areas sum to π.

#include "render/paper/spherical_polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "common/math/direction_mesh.h"
#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

class Random {
public:
    explicit Random(unsigned seed) : generator_(seed) {}

    double number() { return std::uniform_real_distribution<double>()(generator_); }
    std::uint32_t below(std::uint32_t limit) {
        return std::uniform_int_distribution<std::uint32_t>(0, limit - 1)(generator_);
    }
    Vec3d direction() {
        std::normal_distribution<double> normal;
        return Vec3d(normal(generator_), normal(generator_), normal(generator_)).normalized();
    }
    /// Triangle of any shape up to 5 sr and sides of 155 degrees, counter-clockwise. (Nearly
    /// opposite corners, and three nearly on one great circle, leave the sides or the area to
    /// rounding.)
    SphericalTriangle triangle() {
        SphericalTriangle t;
        do {
            t = {direction(), direction(), direction()};
        } while (std::min({t.a.dot(t.b), t.b.dot(t.c), t.c.dot(t.a)}) < -0.9 ||
                 solidAngle(t) > 5.0);
        if (t.a.dot(t.b.cross(t.c)) < 0.0) std::swap(t.b, t.c);
        return t;
    }
    /// Triangle of the given size and of a height as much smaller as `flatness` says.
    SphericalTriangle sliver(double size, double flatness) {
        const Vec3d a = direction();
        Vec3d s, t;
        tangentFrame(a, s, t);
        return {a, (a + s * size).normalized(),
                (a + s * (size * number()) + t * (size * flatness)).normalized()};
    }

private:
    std::mt19937_64 generator_;
};

double area(const ClippedTriangle& clipped) {
    double sum = 0.0;
    for (int i = 0; i < clipped.count; ++i)
        sum += solidAngle(clipped.pieces[static_cast<std::size_t>(i)]);
    return sum;
}

/// Clips `t` at both sides of the plane and expects two true parts of it.
void expectPartition(const SphericalTriangle& t, const Vec3d& n) {
    // Corners are rounded by 1e-16, so areas by that times a side's length, and by more in large
    // triangles, where the area depends on the corners more steeply.
    const double side =
        std::sqrt(std::max({(t.b - t.a).length2(), (t.c - t.b).length2(), (t.a - t.c).length2()}));
    const double tolerance = side < 1.2 ? 4e-15 * side : 1e-13;
    EXPECT_NEAR(area(clipToHemisphere(t, n)) + area(clipToHemisphere(t, -n)), solidAngle(t),
                tolerance);
    const ClippedTriangle clipped = clipToHemisphere(t, n);
    for (int i = 0; i < clipped.count; ++i) {
        const SphericalTriangle& piece = clipped.pieces[static_cast<std::size_t>(i)];
        EXPECT_GT(solidAngle(piece), 0.0);
        EXPECT_GT(piece.a.dot((piece.b - piece.a).cross(piece.c - piece.a)), 0.0);
        for (const Vec3d& corner : {piece.a, piece.b, piece.c}) {
            EXPECT_GT(corner.dot(n), -3e-15);
            EXPECT_NEAR(corner.length(), 1.0, 1e-15);
        }
    }
}

TEST(ClipToHemisphere, KeepsTheWholeAndDropsTheHidden) {
    const SphericalTriangle t{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const Vec3d n = Vec3d(1, 1, 1).normalized();
    const ClippedTriangle whole = clipToHemisphere(t, n);
    ASSERT_EQ(whole.count, 1);
    EXPECT_EQ(whole.pieces[0].a, t.a);
    EXPECT_EQ(whole.pieces[0].b, t.b);
    EXPECT_EQ(whole.pieces[0].c, t.c);
    EXPECT_EQ(clipToHemisphere(t, -n).count, 0);
}

TEST(ClipToHemisphere, CutsInHalf) {
    const SphericalTriangle t{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const ClippedTriangle half = clipToHemisphere(t, Vec3d(1, -1, 0).normalized());
    ASSERT_EQ(half.count, 1);
    EXPECT_NEAR(solidAngle(half.pieces[0]), kPi / 4, 1e-15);
}

TEST(ClipToHemisphere, PartitionsRandomTriangles) {
    Random random(1);
    for (int i = 0; i < 50000; ++i) expectPartition(random.triangle(), random.direction());
}

TEST(ClipToHemisphere, PartitionsCellsOfEveryLevel) {
    Random random(2);
    for (int level = 0; level <= kMaxDirectionLevel; ++level) {
        for (int i = 0; i < 2000; ++i) {
            const SphericalTriangle t = cellTriangle(level, random.below(cellCount(level)));
            // A plane through a point of the cell, so that it is cut.
            const Vec3d inside = sampleDirection(t, random.number(), random.number());
            expectPartition(t, inside.cross(random.direction()).normalized());
        }
    }
}

TEST(ClipToHemisphere, PartitionsWithCornersOnTheHorizon) {
    Random random(3);
    for (int i = 0; i < 20000; ++i) {
        const SphericalTriangle t = random.triangle();
        expectPartition(t, t.a.cross(random.direction()).normalized());
        expectPartition(t, t.b.cross(t.c).normalized());
        expectPartition(t, t.a.cross((t.b + t.c).normalized()).normalized());
    }
    // Heights that are exactly 0.
    const SphericalTriangle octant{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (const Vec3d& n :
         {Vec3d(1, 0, 0), Vec3d(0, -1, 0), Vec3d(0, 0.6, 0.8), Vec3d(0.6, 0, -0.8)})
        expectPartition(octant, n);
    EXPECT_EQ(clipToHemisphere(octant, {-1, 0, 0}).count, 0);
    EXPECT_EQ(clipToHemisphere(octant, {1, 0, 0}).count, 1);
}

TEST(ClipToHemisphere, PartitionsSlivers) {
    Random random(4);
    for (const double size : {1.0, 1e-2, 1e-5}) {
        for (const double flatness : {1e-3, 1e-6, 1e-9}) {
            for (int i = 0; i < 2000; ++i) {
                const SphericalTriangle t = random.sliver(size, flatness);
                const Vec3d inside = sampleDirection(t, random.number(), random.number());
                expectPartition(t, inside.cross(random.direction()).normalized());
                expectPartition(t, t.a.cross(t.b).normalized());
            }
        }
    }
}

TEST(VectorArea, MatchesKnownValues) {
    const Vec3d octant = vectorArea({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    EXPECT_LT((octant - Vec3d(kPi / 4)).length(), 1e-15);
}

TEST(VectorArea, OfTheFinestCellsPointsAtThem) {
    for (std::uint32_t i = 0; i < cellCount(kMaxDirectionLevel); i += 10007) {
        const SphericalTriangle t = cellTriangle(kMaxDirectionLevel, i);
        const Vec3d v = vectorArea(t) / solidAngle(t);
        EXPECT_LT((v - cellCenter(kMaxDirectionLevel, i)).length(), 1e-6);
    }
}

// The cosine over a hemisphere integrates to pi, whatever the cells that the horizon cuts.
TEST(VectorArea, OfClippedCellsSumsToPi) {
    Random random(5);
    for (int level = 0; level <= 5; ++level) {
        for (int i = 0; i < 10; ++i) {
            const Vec3d n = random.direction();
            double sum = 0.0;
            for (std::uint32_t cell = 0; cell < cellCount(level); ++cell) {
                const ClippedTriangle clipped = clipToHemisphere(cellTriangle(level, cell), n);
                for (int p = 0; p < clipped.count; ++p)
                    sum += n.dot(vectorArea(clipped.pieces[static_cast<std::size_t>(p)]));
            }
            EXPECT_NEAR(sum, kPi, 1e-12);
        }
    }
}

/// Cosines to a fixed axis of directions sampled uniformly over a large triangle.
std::vector<double> sampledCosines(const SphericalTriangle& t, const Vec3d& axis) {
    Random random(6);
    std::vector<double> cosines(200000);
    for (double& c : cosines) c = sampleDirection(t, random.number(), random.number()).dot(axis);
    return cosines;
}

TEST(VectorArea, AgreesWithTheMeanOfSamples) {
    const SphericalTriangle t = Random(7).triangle();
    const Vec3d axis = Vec3d(0.3, -0.5, 0.8).normalized();
    const double mean = vectorArea(t).dot(axis) / solidAngle(t);
    const std::vector<double> cosines = sampledCosines(t, axis);
    EXPECT_GT(test::meanPValue(cosines, mean), test::significance(1));
    // Control: an error of 0.01 is seen.
    EXPECT_LT(test::meanPValue(cosines, mean + 0.01), test::significance(1));
}

}  // namespace
}  // namespace shadowcache
