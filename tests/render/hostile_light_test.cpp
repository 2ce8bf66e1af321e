// All of the light in one texel, where that is hardest: on the horizon, at the pole, at a vertex of
// the regions.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/math/direction_mesh.h"
#include "render/estimators/estimator.h"
#include "render/table/estimator_table.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr int kMapWidth = 32, kMapHeight = 16;

struct Spot {
    std::string name;
    Vec3d direction;  ///< some direction in the lit texel
    Vec3f from;       ///< above the place that is lit
    Vec3f along{0, -1, 0};
};

std::vector<Spot> spots() {
    return {{"JustAboveTheHorizon", Vec3d(1, 0.08, 0.4).normalized(), {-0.7f, 0.2f, -0.4f}},
            {"AcrossTheHorizonOfASlope",
             Vec3d(0.5, 0.75, 0.2).normalized(),
             {-0.7f, 0.7f, 1.6f},
             {0, -1, 0}},
            {"AtThePole", {0.01, 1, 0.02}, {-0.45f, 0.2f, 0.1f}},
            {"AtAVertex", {0, 0, 0}, {-1.1f, 0.2f, 0.6f}}};
}

/// Floor, a roof with an edge near the places, and a slope.
TriangleMesh setMesh() {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addFloor(mesh, 1, -0.4f, 1, -1, 1.2f);
    test::addBox(mesh, {0.5f, 0, 0.2f}, {0.9f, 0.3f, 1});
    test::addQuad(mesh, {-1.2f, 0, 1.3f}, {-1.2f, 0, 1.9f}, {-0.4f, 1, 1.9f}, {-0.4f, 1, 1.3f});
    return mesh;
}

class HostileLight : public testing::TestWithParam<std::size_t> {};

INSTANTIATE_TEST_SUITE_P(Spots, HostileLight, testing::Range<std::size_t>(0, spots().size()),
                         [](const auto& test) { return spots()[test.param].name; });

// With its control: those that look for the light must not agree with 10 % more.
TEST_P(HostileLight, IsEstimatedWithoutBias) {
    Spot spot = spots()[GetParam()];
    if (spot.name == "AtAVertex") {
        // The highest vertex of the coarsest level: five regions of every level meet there.
        for (std::uint32_t c = 0; c < cellCount(0); ++c) {
            const SphericalTriangle t = cellTriangle(0, c);
            for (const Vec3d& v : {t.a, t.b, t.c})
                if (v.y < 0.99 && v.y > spot.direction.y) spot.direction = v;
        }
    }
    const TriangleMesh mesh = setMesh();
    const Scene scene(mesh);
    const auto [x, y] = test::texelAt(kMapWidth, kMapHeight, spot.direction.normalized());
    const Image map = test::oneTexelMap(kMapWidth, kMapHeight, x, y, Rgb(300, 200, 100));
    const Environment environment = test::environmentOf(map);
    BakeOptions bakeOptions;
    bakeOptions.spacing = 0.3;
    const test::TestCache cache(bake(scene, bakeOptions));
    EstimatorOptions options;
    options.paper.triangles = 1500;
    const auto estimators = test::everyEstimator({scene, environment, &cache.cache(), {}}, options);
    const ShadingPoint point = test::pointAlong(scene, spot.from, spot.along);
    const Rgb truth = test::tracedIrradiance(scene, point, map, 1500);
    const double whole = test::texelMoment(kMapWidth, kMapHeight, x, y).length() * 300;
    EXPECT_GT(static_cast<double>(truth.x), 1e-3 * whole) << "the place tells nothing";
    const double level = test::significance(2 * estimators.size());
    for (const auto& [name, estimator] : estimators)
        for (const int samples : {3, 64}) {
            const auto estimates = test::runEstimator(*estimator, point, samples, 1500);
            EXPECT_GT(test::agreementPValue(estimates, truth), level)
                << name << ", " << samples << " samples: mean " << estimates.mean(0)
                << ", standard error " << std::sqrt(estimates.sampleVariance(0) / 1500)
                << ", wanted " << truth.x << " of " << whole;
            if (samples < 64 || name == "uniform" || name == "cosine") continue;
            EXPECT_LT(test::agreementPValue(estimates, truth * 1.1f), level) << name;
        }
}

TEST(BlackLight, IsBlackExactly) {
    const TriangleMesh mesh = setMesh();
    const Scene scene(mesh);
    const Environment environment = test::environmentOf(test::constantMap(Rgb(0, 0, 0)));
    BakeOptions bakeOptions;
    bakeOptions.spacing = 0.5;
    const test::TestCache cache(bake(scene, bakeOptions));
    EstimatorOptions options;
    options.paper.triangles = 1500;
    const ShadingPoint point = test::pointAlong(scene, {-0.7f, 0.2f, 0.1f}, {0, -1, 0});
    for (const auto& [name, estimator] :
         test::everyEstimator({scene, environment, &cache.cache(), {}}, options)) {
        const auto estimates = test::runEstimator(*estimator, point, 16, 5);
        for (int c = 0; c < 3; ++c) {
            EXPECT_EQ(estimates.mean(c), 0.0) << name;
            EXPECT_EQ(estimates.sampleVariance(c), 0.0) << name;
        }
    }
}

}  // namespace
}  // namespace shadowcache
