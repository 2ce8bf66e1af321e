// The paper's triangulation of the map, from the fewest triangles to the most.

#include "render/paper/triangulation.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/frame/options.h"
#include "render/table/estimator_table.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

struct Wish {
    int count, minLevel, maxLevel;
};

class Triangulation : public testing::TestWithParam<Wish> {};

INSTANTIATE_TEST_SUITE_P(Counts, Triangulation,
                         testing::Values(Wish{20, 3, 6}, Wish{22, 3, 6}, Wish{79, 3, 6},
                                         Wish{80, 3, 3}, Wish{1279, 3, 6}, Wish{5000, 3, 6},
                                         Wish{100000, 3, 6}, Wish{100000, 3, 7}),
                         [](const auto& test) {
                             return fmt::format("{}DownToLevel{}", test.param.count,
                                                test.param.maxLevel);
                         });

TEST_P(Triangulation, CoversTheSphereOnceWithAllTheLight) {
    const Wish wish = GetParam();
    const Environment environment = test::environmentOf(test::noiseMap(256, 128, 4));
    const auto triangles = triangulateMap(environment, wish.count, wish.minLevel, wish.maxLevel);
    const auto count = static_cast<std::uint32_t>(triangles.size());
    // Splitting one adds three; no more than there are at the highest level.
    const auto most = std::min(static_cast<std::uint32_t>(wish.count), cellCount(wish.maxLevel));
    EXPECT_LE(count, most);
    EXPECT_GT(count + 3, most);
    double area = 0, luminanceIntegral = 0;
    std::uint64_t next = 0;  // in cells of the finest level
    for (const MapTriangle& t : triangles) {
        area += t.area;
        luminanceIntegral += t.luminanceIntegral;
        const int shift = 2 * (kMaxDirectionLevel - t.level);
        EXPECT_EQ(std::uint64_t{t.cell} << shift, next);
        next = (std::uint64_t{t.cell} + 1) << shift;
        EXPECT_LE(t.level, wish.maxLevel);
    }
    EXPECT_EQ(next, cellCount(kMaxDirectionLevel));
    EXPECT_NEAR(area / (4 * kPi), 1, 1e-9);
    EXPECT_NEAR(luminanceIntegral / environment.luminanceIntegral(), 1, 1e-6);
}

TEST(TriangleCount, OutOfRangeIsRefused) {
    PaperOptions options;
    for (const int count : {20, 100000}) {
        options.triangles = count;
        EXPECT_NO_THROW(validate(options));
    }
    for (const int count : {-1, 0, 19, 100001}) {
        options.triangles = count;
        test::expectError([&] { validate(options); }, "--triangles", "20 to 100000");
    }
}

// With its control: at 64 samples the same estimates must not agree with 15 % more.
TEST(TriangleCount, ChangesNoMean) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addBox(mesh, {0.2f, 0, -0.3f}, {0.7f, 0.8f, 0.4f});
    const Scene scene(mesh);
    const Image map = test::noiseMap(16, 8, 3);
    const Environment environment = test::environmentOf(map);
    BakeOptions bakeOptions;
    bakeOptions.spacing = 0.5;
    const test::TestCache cache(bake(scene, bakeOptions));
    const ShadingPoint point = test::pointAlong(scene, {0, 0.3f, 0.1f}, {0, -1, 0});
    const Rgb truth = test::tracedIrradiance(scene, point, map, 64);
    const double level = test::significance(6);
    for (const int triangles : {20, 100, 100000}) {
        EstimatorOptions options;
        options.paper.triangles = triangles;
        options.paper.maxLevel = 7;
        const auto paper =
            findEstimator("paper").make({scene, environment, &cache.cache(), {}}, options);
        for (const auto& [samples, count] : {std::pair(1, 1000), std::pair(64, 600)}) {
            const auto estimates = test::runEstimator(*paper, point, samples, count);
            EXPECT_GT(test::agreementPValue(estimates, truth), level)
                << triangles << " triangles, " << samples << " samples: mean " << estimates.mean(1)
                << ", standard error " << std::sqrt(estimates.sampleVariance(1) / count)
                << ", wanted " << truth.y;
            if (samples == 64) {
                EXPECT_LT(test::agreementPValue(estimates, truth * 1.15f), level) << triangles;
            }
        }
    }
}

}  // namespace
}  // namespace shadowcache
