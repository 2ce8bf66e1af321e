// Walls far thinner than a voxel, lit on one side: no light leaks through the cache.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "common/random/sequence.h"
#include "render/estimators/estimator.h"
#include "render/table/estimator_table.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr double kWallSpacing = 0.25;

/// Places in the middle of a closed room's walls, and what the cache says of both sides.
class ThinWall {
public:
    explicit ThinWall(TriangleMesh room)
        : mesh_(std::move(room)),
          scene_(mesh_),
          environment_(test::environmentOf(test::constantMap(Rgb(1, 1, 1)))),
          cache_(baked()),
          estimator_(findEstimator("cache").make({scene_, environment_, &cache_.cache(), {}})) {}

    /// Ends of the rays from `from` in every direction of a spiral.
    std::vector<ShadingPoint> places(bool inside) const {
        std::vector<ShadingPoint> all;
        for (int i = 0; i < 40; ++i) {
            const double y = 1 - (2 * i + 1) / 40.0, phi = 2.4 * i;
            const double r = std::sqrt(1 - y * y);
            const Vec3f out(Vec3d(r * std::cos(phi), y, r * std::sin(phi)));
            all.push_back(inside ? test::pointAlong(scene_, {0, 0, 0}, out)
                                 : test::pointAlong(scene_, out * 5.0f, -out));
        }
        return all;
    }
    test::Estimates estimate(const ShadingPoint& point, int samples, int count) const {
        return test::runEstimator(*estimator_, point, samples, count);
    }

private:
    BakeResult baked() const {
        BakeOptions options;
        options.spacing = kWallSpacing;
        return bake(scene_, options);
    }

    TriangleMesh mesh_;
    Scene scene_;
    Environment environment_;
    test::TestCache cache_;
    std::unique_ptr<Estimator> estimator_;
};

TEST(ThinWall, OfOneSurfaceLeaksNeitherLightNorDark) {
    TriangleMesh mesh;
    test::addBox(mesh, {-1, -1, -1}, {1, 1, 1});
    const ThinWall wall(std::move(mesh));
    for (const int samples : {0, 16}) {
        for (const ShadingPoint& point : wall.places(true)) {
            EXPECT_EQ(wall.estimate(point, samples, 5).mean(0), 0.0) << point.place.position;
        }
        for (const ShadingPoint& point : wall.places(false)) {
            // Regions across the horizon are left to samples.
            EXPECT_NEAR(wall.estimate(point, samples, 5).mean(0) / kPi, 1, 2e-2)
                << point.place.position;
        }
    }
}

// The cavity between the walls faces outward, too, in the same voxels: it has items of its own.
TEST(ThinWall, OfTwoSkinsLeaksNoLight) {
    TriangleMesh mesh;
    test::addBox(mesh, {-1, -1, -1}, {1, 1, 1});
    test::addBox(mesh, {-0.99f, -0.99f, -0.99f}, {0.99f, 0.99f, 0.99f});
    const ThinWall wall(std::move(mesh));
    for (const ShadingPoint& point : wall.places(true))
        for (const int samples : {0, 16})
            EXPECT_EQ(wall.estimate(point, samples, 5).mean(0), 0.0) << point.place.position;
    const auto places = wall.places(false);
    const double level = test::significance(places.size());
    for (const ShadingPoint& point : places) {
        EXPECT_NEAR(wall.estimate(point, 0, 1).mean(0) / kPi, 1, 2e-2) << point.place.position;
        const auto estimates = wall.estimate(point, 16, 200);
        const Rgb truth(static_cast<float>(kPi));
        EXPECT_GT(test::agreementPValue(estimates, truth), level) << point.place.position;
        // Control.
        EXPECT_LT(test::agreementPValue(estimates, truth * 1.05f), level) << point.place.position;
    }
}

}  // namespace
}  // namespace shadowcache
