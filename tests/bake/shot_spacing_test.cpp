// How the spacing of a shot's cache follows what its pictures are worth.

#include "bake/shot/shot_spacing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bake/core/voxel_frame.h"
#include "common/mesh/mesh.h"

namespace shadowcache {
namespace {

constexpr double kSpacing = 0.5;
constexpr int kVoxels = 64;  ///< along each side of the floor

TriangleMesh squareFloor() {
    constexpr float kSide = static_cast<float>(kSpacing * kVoxels);
    TriangleMesh mesh;
    mesh.positions = {{0, 0, 0}, {kSide, 0, 0}, {kSide, 0, kSide}, {0, 0, kSide}};
    mesh.triangles.emplace_back(0, 2, 1);
    mesh.triangles.emplace_back(0, 3, 2);
    return mesh;
}

/// Lookups a bit above the middle of each voxel of the floor.
LookupPlaces lookupsOf(const VoxelFrame& frame) {
    std::vector<LookupPlaces::Place> seen;
    for (int x = 0; x < kVoxels; ++x)
        for (int z = 0; z < kVoxels; ++z)
            seen.push_back(
                LookupPlaces::makePlace(frame.key({x, 0, z}), {0.2f, 0.1f, 0.2f}, {0, 1, 0}));
    LookupPlaces places;
    places.add(seen);
    return places;
}

class ShotSpacing : public testing::Test {
protected:
    double factorFor(double pixels) const {
        return resolutionOfShot(places_, frame_, pixels).factor;
    }

    const TriangleMesh mesh_ = squareFloor();
    const VoxelFrame frame_{mesh_, kSpacing};
    const LookupPlaces places_ = lookupsOf(frame_);
};

TEST_F(ShotSpacing, IsTheSetsOwnForManyPixels) {
    EXPECT_EQ(factorFor(1e9), 1);
    EXPECT_EQ(resolutionOfShot(places_, frame_, 1e9).level, 5);
}

TEST_F(ShotSpacing, FollowsThePixelsByTheSquareRoot) {
    // A floor has items in inverse proportion to the square of the spacing.
    const double few = factorFor(1200), more = factorFor(9600);
    EXPECT_GT(few, 4);
    EXPECT_LT(few, 16);
    EXPECT_NEAR(few / more, std::sqrt(8.0), 0.6);
    EXPECT_EQ(resolutionOfShot(places_, frame_, 1200).level, 4);
}

TEST_F(ShotSpacing, IsThatOfTheLevelGiven) {
    const ShotResolution finest = resolutionOfShot(places_, frame_, 4000, 5),
                         coarse = resolutionOfShot(places_, frame_, 4000, 4);
    EXPECT_EQ(finest.level, 5);
    EXPECT_EQ(coarse.level, 4);
    // Four times the rays.
    EXPECT_NEAR(finest.factor / coarse.factor, 2, 0.6);
}

TEST_F(ShotSpacing, HasALimit) {
    EXPECT_LE(factorFor(1), 16.01);
    EXPECT_GT(factorFor(1), 15.9);
}

TEST_F(ShotSpacing, IsTheSetsOwnWhereNothingIsSeen) {
    EXPECT_EQ(resolutionOfShot({}, frame_, 1).factor, 1);
}

TEST_F(ShotSpacing, LookupsStayWhereTheyAre) {
    const VoxelFrame coarse(mesh_, 3 * kSpacing);
    const LookupPlaces moved = inVoxelsOf(coarse, places_, frame_);
    ASSERT_FALSE(moved.places().empty());
    const auto inWorld = [](const LookupPlaces::Place& place, const VoxelFrame& frame) {
        return (Vec3d(frame.voxel(place.voxelKey)) + Vec3d(place.position())) * frame.spacing();
    };
    // Each is one of those before, to the rounding of both.
    const double rounding = (coarse.spacing() + kSpacing) / 16 * std::sqrt(3.0);
    for (const LookupPlaces::Place& place : moved.places()) {
        const Vec3d p = inWorld(place, coarse);
        double nearest = 1e9;
        for (const LookupPlaces::Place& other : places_.places())
            nearest = std::min(nearest, (p - inWorld(other, frame_)).length());
        EXPECT_LE(nearest, rounding);
        EXPECT_GT(place.normal().y, 0.99f);
    }
    // And none is lost: the floor's corners are there.
    Vec3d low(1e9), high(-1e9);
    for (const LookupPlaces::Place& place : moved.places()) {
        const Vec3d p = inWorld(place, coarse);
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    EXPECT_LT(low.x, 2 * kSpacing);
    EXPECT_GT(high.z, kSpacing * (kVoxels - 2));
}

}  // namespace
}  // namespace shadowcache
