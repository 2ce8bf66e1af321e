// Neighbouring points reuse mispredictions: unbiased whatever the cache predicts, and worth it.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/random/sequence.h"
#include "render/estimators/estimator.h"
#include "render/table/estimator_table.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr int kSide = 4;
constexpr std::size_t kPoints = kSide * kSide;

/// A floor under a slab that lets in little light, along one edge; some points see more, some none.
TriangleMesh slitMesh() {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addBox(mesh, {-2, 0.5f, -2}, {1.7f, 0.6f, 2});
    test::addBox(mesh, {-2, 0, -2}, {2, 0.6f, -1.9f});
    test::addBox(mesh, {-2, 0, 1.9f}, {2, 0.6f, 2});
    test::addBox(mesh, {0.9f, 0, -0.1f}, {1, 0.45f, 0.1f});
    return mesh;
}

std::vector<ShadingPoint> floorPoints(const Scene& scene) {
    std::vector<ShadingPoint> points;
    for (int i = 0; i < static_cast<int>(kPoints); ++i) {
        const int column = i % kSide, row = i / kSide;
        const Vec3d from(0.83 + 0.1 * column, 0.2, -0.13 + 0.1 * row);
        points.push_back(test::pointAlong(scene, Vec3f(from), {0, -1, 0}));
    }
    return points;
}

/// The bake of `mesh`, or with `counts` of it all replaced by n of d.
BakeResult bakeOf(const TriangleMesh& mesh, int n, int d) {
    const Scene scene(mesh);
    BakeOptions options;
    options.spacing = 0.5;
    BakeResult result = bake(scene, options);
    if (d == 0) return result;
    std::fill(result.items.n.begin(), result.items.n.end(), static_cast<std::uint8_t>(n));
    std::fill(result.items.d.begin(), result.items.d.end(), static_cast<std::uint8_t>(d));
    result.items.blocks.clear();
    std::fill(result.items.firstBlock.begin(), result.items.firstBlock.end(), 0u);
    return result;
}

/// Estimates of each point, `count` times with numbers of their own; together or one by one.
std::vector<test::Estimates> run(const Estimator& estimator, std::vector<ShadingPoint> points,
                                 int samples, int count, bool together) {
    std::vector<test::Estimates> all(points.size());
    std::vector<Estimate> found(points.size());
    const auto workspace = estimator.makeWorkspace();
    for (int i = 0; i < count; ++i) {
        for (std::size_t p = 0; p < points.size(); ++p)
            points[p].seed = hashWords(static_cast<std::uint64_t>(i), p);
        if (together)
            estimator.estimate(points, samples, *workspace, found);
        else
            for (std::size_t p = 0; p < points.size(); ++p)
                found[p] = estimator.estimate(points[p], samples, *workspace);
        for (std::size_t p = 0; p < points.size(); ++p)
            for (int c = 0; c < 3; ++c)
                all[p].color[static_cast<std::size_t>(c)].push_back(
                    static_cast<double>(found[p].irradiance[c]));
    }
    return all;
}

class Mispredictions : public testing::TestWithParam<std::pair<int, int>> {};

INSTANTIATE_TEST_SUITE_P(Caches, Mispredictions,
                         testing::Values(std::pair(0, 0), std::pair(0, 200), std::pair(200, 200),
                                         std::pair(120, 200), std::pair(190, 200)),
                         [](const auto& test) {
                             return test.param.second == 0
                                        ? std::string("Correct")
                                        : "Says" + std::to_string(test.param.first) + "Of" +
                                              std::to_string(test.param.second);
                         });

// Against `mis`, and with its control: the same estimates must not agree with 10 % more.
TEST_P(Mispredictions, ChangeNoMean) {
    const TriangleMesh mesh = slitMesh();
    const Scene scene(mesh);
    const Environment environment = test::environmentOf(test::noiseMap(16, 8, 3));
    const test::TestCache cache(bakeOf(mesh, GetParam().first, GetParam().second));
    const auto estimator = findEstimator("cache").make({scene, environment, &cache.cache(), {}});
    const std::vector<ShadingPoint> points = floorPoints(scene);
    const auto together = run(*estimator, points, 16, 1500, true);
    const auto mis =
        run(*findEstimator("mis").make({scene, environment, nullptr, {}}), points, 64, 1500, false);
    const double level = test::significance(kPoints);
    int rejected = 0;
    for (std::size_t p = 0; p < kPoints; ++p) {
        std::vector<double> truth = mis[p].color[1];
        EXPECT_GT(test::sameMeanPValue(together[p].color[1], truth), level)
            << "point " << p << ": mean " << together[p].mean(1) << ", mis " << mis[p].mean(1);
        for (double& t : truth) t *= 1.1;
        rejected += test::sameMeanPValue(together[p].color[1], truth) < level;
    }
    EXPECT_GT(rejected, static_cast<int>(kPoints) / 2);
}

// Control: alone, the same points with the same numbers are noisier.
TEST(NeighborReuse, LessensTheNoise) {
    const TriangleMesh mesh = slitMesh();
    const Scene scene(mesh);
    const Environment environment = test::environmentOf(test::noiseMap(16, 8, 3));
    const test::TestCache cache(bakeOf(mesh, 0, 200));
    const auto estimator = findEstimator("cache").make({scene, environment, &cache.cache(), {}});
    const std::vector<ShadingPoint> points = floorPoints(scene);
    const auto together = run(*estimator, points, 16, 200, true);
    const auto alone = run(*estimator, points, 16, 200, false);
    double shared = 0, own = 0;
    for (std::size_t p = 0; p < kPoints; ++p) {
        shared += together[p].sampleVariance(1);
        own += alone[p].sampleVariance(1);
    }
    EXPECT_LT(shared, own / 4);
}

/// The bake of `mesh` but for the base cell around `direction`, all of which counts as occluded.
BakeResult bakeHiding(const TriangleMesh& mesh, const Vec3d& direction) {
    BakeResult result = bakeOf(mesh, 0, 0);
    const DirectionTiers tiers = result.header.tiers();
    const std::uint32_t hidden = locateCell(tiers.baseLevel(), direction);
    CacheItems kept = result.items;
    kept.blocks.clear();
    kept.firstBlock = {0};
    for (std::size_t i = 0; i < kept.size(); ++i) {
        kept.n[i * tiers.baseCells() + hidden] = 0;
        kept.d[i * tiers.baseCells() + hidden] = 200;
        for (std::uint32_t b = result.items.firstBlock[i]; b < result.items.firstBlock[i + 1];
             ++b) {
            const CountBlock& block = result.items.blocks[b];
            const bool first = block.key < tiers.blockKey(1, 0);
            const std::uint32_t parent = first ? block.key : block.key - tiers.blockKey(1, 0);
            if ((first ? parent : parent / kBlockCells) != hidden) kept.blocks.push_back(block);
        }
        kept.firstBlock.push_back(static_cast<std::uint32_t>(kept.blocks.size()));
    }
    result.items = kept;
    return result;
}

/// Sum over the points of the variance of their estimates, together.
double noiseWith(int samples) {
    const TriangleMesh mesh = slitMesh();
    const Scene scene(mesh);
    const Vec3d direction = Vec3d(1, 0.3, 0.05).normalized();
    Image map = test::gradientMap(64, 32, Vec3d(0, 0, 0));
    const auto texel = test::texelAt(64, 32, direction);
    map.pixels[static_cast<std::size_t>(texel[1] * 64 + texel[0])] = Rgb(10, 10, 10);
    const Environment environment = test::environmentOf(map);
    const test::TestCache cache(bakeHiding(mesh, direction));
    const auto estimator = findEstimator("cache").make({scene, environment, &cache.cache(), {}});
    double sum = 0;
    for (const test::Estimates& e : run(*estimator, floorPoints(scene), samples, 400, true))
        sum += e.sampleVariance(1);
    return sum;
}

// More samples leave fewer mispredictions heavy enough to be reused. Were they chosen by the
// samples there are, sixteen times as many would lessen the noise by a factor of only 20; it is 60.
TEST(NeighborReuse, MoreSamplesMeanLessNoise) {
    const double at64 = noiseWith(64);
    EXPECT_LT(noiseWith(1024), at64 / 35);
    EXPECT_GT(noiseWith(256), at64 / 35);  // control
}

}  // namespace
}  // namespace shadowcache
