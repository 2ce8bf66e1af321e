// A cache that is wrong costs noise and nothing else; one that is right takes the noise away.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "common/random/sequence.h"
#include "render/estimators/estimator.h"
#include "render/table/estimator_table.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr double kSpacing = 0.5;

/// A court with a wall, a box and a roof on one side.
TriangleMesh courtMesh() {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addBox(mesh, {-2, 0, -2}, {2, 1.6f, -1.8f});
    test::addBox(mesh, {0.2f, 0, -0.3f}, {0.7f, 0.8f, 0.4f});
    test::addFloor(mesh, 1.2f, -2, -0.8f, -1.8f, 2);
    return mesh;
}

/// Another set over the same voxels: what is visible there is occluded here.
TriangleMesh otherMesh() {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addFloor(mesh, 0.9f, 0, 2, -2, 2);
    return mesh;
}

BakeResult bakeOf(const TriangleMesh& mesh) {
    const Scene scene(mesh);
    BakeOptions options;
    options.spacing = kSpacing;
    return bake(scene, options);
}

struct Counts {
    std::uint8_t n, d;
};

/// The items with every count of every tier replaced by `counts(random number)`.
CacheItems withCounts(CacheItems items, const DirectionTiers& tiers,
                      const std::function<Counts(std::uint64_t)>& counts) {
    std::uint64_t state = 0;
    const auto fill = [&](std::uint8_t& n, std::uint8_t& d) {
        const Counts made = counts(hashWords(17, ++state));
        n = made.n;
        d = made.d;
    };
    for (std::size_t i = 0; i < items.n.size(); ++i) fill(items.n[i], items.d[i]);
    items.blocks.clear();
    items.firstBlock.assign(1, 0);
    for (std::size_t i = 0; i < items.size(); ++i) {
        for (int tier = 0; tier < tiers.refinements(); ++tier)
            // One finest block in eight: enough, and quick.
            for (std::uint32_t cell = 0; cell < cellCount(tiers.baseLevel() + 2 * tier);
                 cell += tier == 0 ? 1 : 8) {
                CountBlock block{tiers.blockKey(tier, cell), {}, {}};
                for (std::size_t k = 0; k < kBlockCells; ++k) fill(block.n[k], block.d[k]);
                items.blocks.push_back(block);
            }
        items.firstBlock.push_back(static_cast<std::uint32_t>(items.blocks.size()));
    }
    return items;
}

struct WrongCache {
    std::string name;
    std::function<Counts(std::uint64_t)> counts;  ///< null: another set's cache
};

std::vector<WrongCache> wrongCaches() {
    const auto byte = [](std::uint64_t h) { return static_cast<std::uint8_t>(h % 256); };
    return {{"AllDark",
             [](std::uint64_t) {
                 return Counts{0, 255};
             }},
            {"AllVisible",
             [](std::uint64_t) {
                 return Counts{255, 255};
             }},
            {"Random",
             [byte](std::uint64_t h) {
                 const std::uint8_t d = byte(h);
                 return Counts{static_cast<std::uint8_t>((h >> 20) % (d + 1u)), d};
             }},
            {"RandomAndCertain",
             [](std::uint64_t h) {
                 return Counts{static_cast<std::uint8_t>(h & 1 ? 255 : 0), 255};
             }},
            {"NothingCounted",
             [](std::uint64_t) {
                 return Counts{0, 0};
             }},
            {"AnotherSets", nullptr}};
}

/// Lets the estimator calibrate the cache, with numbers that no estimate uses.
std::unique_ptr<const EstimatorPlan> planOf(const Estimator& estimator, const ShadingPoint& point) {
    std::vector<ShadingPoint> points(200, point);
    for (std::size_t i = 0; i < points.size(); ++i) points[i].slot.seed = hashWords(i, 1000);
    return estimator.pilot() ? estimator.pilot()->plan(points, 64, 0) : nullptr;
}

class WrongCaches : public testing::TestWithParam<std::size_t> {};

INSTANTIATE_TEST_SUITE_P(All, WrongCaches, testing::Range<std::size_t>(0, wrongCaches().size()),
                         [](const auto& test) { return wrongCaches()[test.param].name; });

// With its control: the same estimates must not agree with 10 % more.
TEST_P(WrongCaches, ChangeNoMean) {
    const TriangleMesh mesh = courtMesh();
    const Scene scene(mesh);
    const Image map = test::noiseMap(16, 8, 3);
    const Environment environment = test::environmentOf(map);
    const WrongCache chosen = wrongCaches()[GetParam()];
    BakeResult wrong = bakeOf(chosen.counts ? mesh : otherMesh());
    if (chosen.counts) wrong.items = withCounts(wrong.items, wrong.header.tiers(), chosen.counts);
    const test::TestCache cache(wrong);
    EstimatorOptions options;
    options.paper.triangles = 1500;
    const EstimatorContext context{scene, environment, &cache.cache(), {}};
    const Vec3f places[] = {{1.3f, 0.3f, 0.7f}, {0.1f, 0.3f, -1}, {-1.1f, 0.5f, 0.2f}};
    const double level = test::significance(2 * 2 * std::size(places));
    for (const std::string name : {"paper", "cache"}) {
        // `paper` takes seconds to set up; two caches will do.
        if (name == "paper" && chosen.name != "RandomAndCertain" && chosen.name != "AnotherSets")
            continue;
        const auto estimator = findEstimator(name).make(context, options);
        for (const Vec3f& place : places) {
            const ShadingPoint point = test::pointAlong(scene, place, {0, -1, 0});
            const Rgb truth = test::tracedIrradiance(scene, point, map, 320);
            const auto plan = planOf(*estimator, point);
            for (const auto& [samples, count] : {std::pair(4, 12000), std::pair(64, 600)}) {
                const auto estimates =
                    test::runEstimator(*estimator, point, samples, count, plan.get());
                const double error = std::sqrt(estimates.sampleVariance(1) / count);
                EXPECT_GT(test::agreementPValue(estimates, truth), level)
                    << name << " at " << place << ", " << samples << " samples: mean "
                    << estimates.mean(1) << ", standard error " << error << ", wanted " << truth.y;
                if (samples < 64) continue;
                EXPECT_LT(test::agreementPValue(estimates, truth * 1.1f), level)
                    << name << " at " << place << ", standard error " << error;
            }
        }
    }
}

/// Variance of one estimate of 64 samples, averaged over `points`.
double meanVariance(const Estimator& estimator, std::span<const ShadingPoint> points,
                    const EstimatorPlan* plan = nullptr) {
    double sum = 0;
    for (const ShadingPoint& point : points)
        sum += test::runEstimator(estimator, point, 64, 40, plan).sampleVariance(1);
    return sum / static_cast<double>(points.size());
}

// The pilot calibrates wrong counts. Control: without it the worst cache costs more.
TEST(CalibratedWrongCache, CostsAtMostTwiceTheNoiseOfMis) {
    const TriangleMesh mesh = courtMesh();
    const Scene scene(mesh);
    const Environment environment = test::environmentOf(test::noiseMap(64, 32, 3));
    std::vector<ShadingPoint> points;
    for (std::uint64_t i = 0; i < 60; ++i) {
        const Vec3f from(static_cast<float>(3 * toUnit(hashWords(i, 1)) - 1.5), 0.3f,
                         static_cast<float>(3 * toUnit(hashWords(i, 2)) - 1.5));
        points.push_back(test::pointAlong(scene, from, {0, -1, 0}));
        points.back().slot.seed = i;
    }
    const EstimatorContext plain{scene, environment, nullptr, {}};
    const double mis = meanVariance(*findEstimator("mis").make(plain), points);
    double worst = 0, worstWithoutPilot = 0;
    for (const WrongCache& chosen : wrongCaches()) {
        BakeResult wrong = bakeOf(chosen.counts ? mesh : otherMesh());
        if (chosen.counts)
            wrong.items = withCounts(wrong.items, wrong.header.tiers(), chosen.counts);
        const test::TestCache cache(wrong);
        const auto estimator =
            findEstimator("cache").make({scene, environment, &cache.cache(), {}});
        worstWithoutPilot = std::max(worstWithoutPilot, meanVariance(*estimator, points));
        const auto plan = estimator->pilot()->plan(points, 64, 0);
        EXPECT_GT(plan->rays, 0u);
        const double variance = meanVariance(*estimator, points, plan.get());
        EXPECT_LT(std::sqrt(variance / mis), 2) << chosen.name;
        worst = std::max(worst, variance);
    }
    EXPECT_GT(std::sqrt(worstWithoutPilot / worst), 1.5);
}

TEST(CorrectCache, LeavesNoNoiseInTheDark) {
    TriangleMesh mesh;
    test::addBox(mesh, {-1, -1, -1}, {1, 1, 1});
    const Scene scene(mesh);
    const Environment environment = test::environmentOf(test::noiseMap(64, 32, 1));
    const test::TestCache cache(bakeOf(mesh));
    const auto estimator = findEstimator("cache").make({scene, environment, &cache.cache(), {}});
    for (const Vec3f& along :
         {Vec3f(0.3f, -1, 0.2f), Vec3f(1, 0.1f, 0.3f), Vec3f(0.9f, 1, -0.8f)}) {
        const ShadingPoint point = test::pointAlong(scene, {0, 0, 0}, along.normalized());
        for (const int samples : {0, 1, 64}) {
            const auto estimates = test::runEstimator(*estimator, point, samples, 50);
            for (int c = 0; c < 3; ++c) {
                EXPECT_EQ(estimates.mean(c), 0.0);
                EXPECT_EQ(estimates.sampleVariance(c), 0.0);
            }
            EXPECT_EQ(*std::max_element(estimates.variance.begin(), estimates.variance.end()), 0.0);
        }
    }
}

TEST(CorrectCache, LeavesNoNoiseInFullLight) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    const Scene scene(mesh);
    const Rgb sun(30, 20, 10);
    const Environment environment = test::environmentOf(test::oneTexelMap(64, 32, 20, 6, sun));
    const test::TestCache cache(bakeOf(mesh));
    const auto estimator = findEstimator("cache").make({scene, environment, &cache.cache(), {}});
    const double truth = test::texelMoment(64, 32, 20, 6).y;
    // Places anywhere in a voxel: the weights of the pooling take all values.
    for (int i = 0; i < 40; ++i) {
        const auto k = static_cast<std::uint64_t>(i);
        const Vec3f place(static_cast<float>(3 * toUnit(hashWords(k, 1)) - 1.5), 1,
                          static_cast<float>(3 * toUnit(hashWords(k, 2)) - 1.5));
        const ShadingPoint point = test::pointAlong(scene, place, {0, -1, 0});
        for (const int samples : {0, 1, 64}) {
            const auto estimates = test::runEstimator(*estimator, point, samples, 30);
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(estimates.mean(c) / (static_cast<double>(sun[c]) * truth), 1, 1e-5);
                EXPECT_EQ(estimates.sampleVariance(c), 0.0) << place << " " << samples;
            }
            EXPECT_EQ(*std::max_element(estimates.variance.begin(), estimates.variance.end()), 0.0);
        }
    }
}

TEST(NegativeEstimates, AreKept) {
    const TriangleMesh mesh = courtMesh();
    const Scene scene(mesh);
    const Environment environment =
        test::environmentOf(test::oneTexelMap(16, 8, 6, 2, Rgb(30, 20, 10)));
    BakeResult baked = bakeOf(mesh);
    baked.items = withCounts(baked.items, baked.header.tiers(), [](std::uint64_t) {
        return Counts{254, 255};
    });
    const test::TestCache cache(baked);
    const auto estimator = findEstimator("cache").make({scene, environment, &cache.cache(), {}});
    double least = 0;
    for (const float x : {-1.5f, -0.5f, 0.1f, 0.9f, 1.5f}) {
        const ShadingPoint point = test::pointAlong(scene, {x, 0.3f, 0.6f}, {0, -1, 0});
        const auto estimates = test::runEstimator(*estimator, point, 1, 200);
        least = std::min(least,
                         *std::min_element(estimates.color[0].begin(), estimates.color[0].end()));
    }
    EXPECT_LT(least, -0.01);
}

}  // namespace
}  // namespace shadowcache
