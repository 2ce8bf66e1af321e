// Neighbouring points reuse mispredictions: unbiased whatever the cache predicts, and worth it.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "common/random/sequence.h"
#include "render/table/estimator_table.h"
#include "tests/support/lit_floor.h"
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

BakeResult bakeOf(const TriangleMesh& mesh) {
    BakeOptions options;
    options.spacing = 0.5;
    return bake(Scene(mesh), options);
}

/// What a cache tells of each base cell of each item: n of d rays.
struct Told {
    std::string name;
    std::function<std::array<int, 2>(std::size_t)> counts;  ///< null: what the bake found
};

/// What a test's name shows.
std::ostream& operator<<(std::ostream& out, const Told& told) {
    return out << told.name;
}

Told tells(int n, int d) {
    return {fmt::format("Says{}Of{}", n, d), [=](std::size_t) { return std::array{n, d}; }};
}

/// Every other cell is visible, all others are not: both kinds of mispredictions are heavy.
Told tellsOther() {
    return {"SaysEveryOther", [](std::size_t i) { return std::array{i % 2 == 0 ? 200 : 0, 200}; }};
}

/// Lights points that are the only ones of their pixels.
using LightPoints = std::vector<Rgb>(const Estimator&, std::span<const ShadingPoint>, int samples,
                                     Workspace&);

/// One value of each estimate.
template <typename T>
std::vector<Rgb> valuesOf(const std::vector<T>& estimates, Rgb T::*value) {
    std::vector<Rgb> values;
    values.reserve(estimates.size());
    for (const T& estimate : estimates) values.push_back(estimate.*value);
    return values;
}

std::vector<Rgb> irradianceOf(const Estimator& estimator, std::span<const ShadingPoint> points,
                              int samples, Workspace& workspace) {
    std::vector<Estimate> found(points.size());
    estimator.estimate(points, samples, workspace, found);
    return valuesOf(found, &Estimate::irradiance);
}

/// What a metal floor reflects to a viewer who looks toward the slit. It is rougher toward there,
/// so that one fit follows no lobe exactly.
std::vector<Rgb> reflectionOf(const Estimator& estimator, std::span<const ShadingPoint> points,
                              int samples, Workspace& workspace) {
    const Vec3f toViewer = Vec3f(-0.8f, 0.35f, 0.05f).normalized();
    std::vector<ShadingPoint> alone(points.begin(), points.end());
    std::vector<GlossyPoint> lobes;
    for (std::size_t i = 0; i < alone.size(); ++i) {
        alone[i].slot.pixel = static_cast<std::uint32_t>(i);
        const float roughness = 0.28f + 0.8f * (alone[i].place.rayOrigin.x - 0.8f);
        const Surface metal =
            glossy(Rgb(0.9f, 0.7f, 0.3f), {.metallic = 1, .roughness = roughness});
        lobes.push_back({alone[i], GlossyLobe(metal, alone[i].place.normal, toViewer)});
    }
    PointBatch batch{alone, samples, static_cast<std::uint32_t>(alone.size())};
    std::vector<GlossEstimate> found(points.size());
    estimator.estimateGloss(batch, lobes, workspace, found);
    return valuesOf(found, &GlossEstimate::radiance);
}

/// The same with 1.5 samples of every other point, and 0.5 of the rest.
template <LightPoints& light>
std::vector<Rgb> byShares(const Estimator& estimator, std::span<const ShadingPoint> points,
                          int samples, Workspace& workspace) {
    std::vector<ShadingPoint> shared(points.begin(), points.end());
    for (std::size_t i = 0; i < shared.size(); ++i)
        shared[i].slot.sampleFraction = (i % 2 == 0 ? 1.5f : 0.5f) / static_cast<float>(samples);
    return light(estimator, shared, samples, workspace);
}

/// Estimates of each point, `count` times with numbers of their own; together or one by one.
std::vector<test::Estimates> run(LightPoints& light, const Estimator& estimator,
                                 std::vector<ShadingPoint> points, int samples, int count,
                                 bool together) {
    std::vector<test::Estimates> all(points.size());
    const auto workspace = estimator.makeWorkspace();
    for (int i = 0; i < count; ++i) {
        for (std::size_t p = 0; p < points.size(); ++p)
            points[p].slot.seed = hashWords(static_cast<std::uint64_t>(i), p);
        std::vector<Rgb> found;
        if (together)
            found = light(estimator, points, samples, *workspace);
        else
            for (std::size_t p = 0; p < points.size(); ++p)
                found.push_back(light(estimator, {&points[p], 1}, samples, *workspace).front());
        for (std::size_t p = 0; p < points.size(); ++p)
            for (int c = 0; c < 3; ++c)
                all[p].color[static_cast<std::size_t>(c)].push_back(
                    static_cast<double>(found[p][c]));
    }
    return all;
}

class Mispredictions : public testing::TestWithParam<Told> {};

INSTANTIATE_TEST_SUITE_P(Caches, Mispredictions,
                         testing::Values(Told{"Correct", nullptr}, tells(0, 200), tells(200, 200),
                                         tells(120, 200), tells(190, 200), tellsOther()),
                         [](const auto& test) { return test.param.name; });

/// A slit, a cache of it, and points on the floor.
struct Slit {
    explicit Slit(const Told& told) : cache(baked(told)) {}

    std::vector<test::Estimates> run(LightPoints& light, const std::string& name, int samples,
                                     int count, bool together) const {
        const auto estimator = findEstimator(name).make({scene, environment, &cache.cache(), {}});
        return shadowcache::run(light, *estimator, floorPoints(scene), samples, count, together);
    }

    const TriangleMesh mesh = slitMesh();
    const Scene scene{mesh};
    const Environment environment = test::environmentOf(test::noiseMap(16, 8, 3));
    const test::TestCache cache;

private:
    BakeResult baked(const Told& told) const {
        BakeResult result = bakeOf(mesh);
        if (told.counts) test::fillCounts(result, told.counts);
        return result;
    }
};

/// `cache`, all points together, against `mis`, and with a control: the same estimates must not
/// agree with 10 % more.
void expectMeansOfMis(LightPoints& light, const Slit& slit, int misSamples) {
    const auto together = slit.run(light, "cache", 16, 1500, true);
    const auto mis = slit.run(light, "mis", misSamples, 1500, false);
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

/// Noise of points together over that of the same points alone, with the same numbers.
double noiseTogether(LightPoints& light, const Slit& slit) {
    const auto together = slit.run(light, "cache", 16, 200, true);
    const auto alone = slit.run(light, "cache", 16, 200, false);
    double shared = 0, own = 0;
    for (std::size_t p = 0; p < kPoints; ++p) {
        shared += together[p].sampleVariance(1);
        own += alone[p].sampleVariance(1);
    }
    return shared / own;
}

TEST_P(Mispredictions, ChangeNoMean) {
    expectMeansOfMis(irradianceOf, Slit(GetParam()), 64);
}

// Where every other cell is visible, c is rounded to 1 in these: there the fit's error is added
// whatever a ray finds, and an occluder is a misprediction.
TEST_P(Mispredictions, ChangeNoMeanOfAMetal) {
    expectMeansOfMis(reflectionOf, Slit(GetParam()), 128);
}

/// Sums of all points' estimates.
std::vector<double> totalsOf(const std::vector<test::Estimates>& points) {
    std::vector<double> totals(points.front().color[1].size());
    for (const test::Estimates& point : points)
        for (std::size_t i = 0; i < totals.size(); ++i) totals[i] += point.color[1][i];
    return totals;
}

/// With `byShares` against `mis` with all samples. Control: 4 % more.
void expectTotalOfMis(LightPoints& byShares, LightPoints& light, const Told& told) {
    const Slit slit(told);
    const auto cache = totalsOf(slit.run(byShares, "cache", 16, 20000, true));
    std::vector<double> mis = totalsOf(slit.run(light, "mis", 128, 5000, false));
    const double level = test::significance(4);
    EXPECT_GT(test::sameMeanPValue(cache, mis), level) << told.name;
    for (double& value : mis) value *= 1.04;
    EXPECT_LT(test::sameMeanPValue(cache, mis), level) << told.name;
}

// 1.5 and 0.5 samples are rounded together: to 1 and 1, or to 2 and none.
TEST(NeighborReuse, ChangesNoMeanOfPointsThatShareDifferently) {
    for (const Told& told : {tells(0, 200), tellsOther()})
        expectTotalOfMis(byShares<irradianceOf>, irradianceOf, told);
}

TEST(NeighborReuse, ChangesNoMeanOfAMetalWhosePointsShareDifferently) {
    for (const Told& told : {tells(0, 200), tellsOther()})
        expectTotalOfMis(byShares<reflectionOf>, reflectionOf, told);
}

// Points alone are the control.
TEST(NeighborReuse, LessensTheNoise) {
    EXPECT_LT(noiseTogether(irradianceOf, Slit(tells(0, 200))), 1 / 4.0);
}

TEST(NeighborReuse, LessensTheNoiseOfAMetal) {
    EXPECT_LT(noiseTogether(reflectionOf, Slit(tells(0, 200))), 1 / 2.0);
    EXPECT_LT(noiseTogether(reflectionOf, Slit(tellsOther())), 1 / 2.0);
}

/// Four pixels of four camera rays each, where a direction through the slit concerns few points of
/// a row, which has one camera ray of each pixel or more: sums of the pixels' irradiance.
struct PixelSums {
    std::vector<test::Estimates> dark{kSide / 2}, bright{kSide / 2};
    double ownVariance = 0;  ///< of all pixels, as their points' estimates have it, in the mean
    double covariance = 0;   ///< the same of that between their camera rays

    double variance() const {
        double sum = 0;
        for (const auto* pixels : {&dark, &bright})
            for (const test::Estimates& pixel : *pixels) sum += pixel.sampleVariance(1);
        return sum;
    }
};

/// Whatever few points receive is heavy to pixels of this brightness.
constexpr float kDark = 0.01f;

/// @param bright  brightness of the other pixels
/// @param apart  each row is a batch of its own
/// @param raysOfRow  camera rays of a pixel that are in one row
PixelSums sumPixels(const std::string& name, const Told& told, int samples, int count, float bright,
                    bool apart, std::uint32_t raysOfRow = 1) {
    const Slit slit(told);
    const auto estimator =
        findEstimator(name).make({slit.scene, slit.environment, &slit.cache.cache(), {}});
    const auto workspace = estimator->makeWorkspace();
    std::vector<ShadingPoint> points = floorPoints(slit.scene);
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        points[i].slot.cameraRay = i / kSide;
        points[i].slot.row = points[i].slot.cameraRay / raysOfRow;
        points[i].slot.sampleFraction = i % 2 == 0 ? 1.0f : 1.0f / static_cast<float>(raysOfRow);
        points[i].slot.pixel = (i + i / kSide) % kSide;
        points[i].slot.errorScale = points[i].slot.pixel < kSide / 2 ? kDark : bright;
    }
    if (!apart)
        std::ranges::sort(points, {}, [](const ShadingPoint& point) {
            return std::pair(point.slot.pixel, point.slot.cameraRay);
        });
    PixelSums sums;
    for (int k = 0; k < count; ++k) {
        std::array<double, kSide> irradiance{};
        for (std::size_t i = 0; i < kPoints; ++i)
            points[i].slot.seed = hashWords(static_cast<std::uint64_t>(k), points[i].slot.pixel);
        const std::size_t together = apart ? kSide : kPoints;
        for (std::size_t begin = 0; begin < kPoints; begin += together) {
            PointBatch batch{{&points[begin], together}, samples, kSide, kSide};
            std::vector<Estimate> found(together);
            estimator->estimate(batch, *workspace, found);
            for (std::size_t i = 0; i < together; ++i) {
                irradiance[points[begin + i].slot.pixel] +=
                    static_cast<double>(found[i].irradiance.y);
                sums.ownVariance += static_cast<double>(found[i].variance) / count;
                sums.covariance += static_cast<double>(found[i].covariance) / count;
            }
        }
        for (std::size_t p = 0; p < kSide / 2; ++p) {
            sums.dark[p].color[1].push_back(irradiance[p]);
            sums.bright[p].color[1].push_back(irradiance[kSide / 2 + p]);
        }
    }
    return sums;
}

/// Control: 4 % more.
void expectSameTotal(const std::vector<test::Estimates>& found,
                     const std::vector<test::Estimates>& truth) {
    const double level = test::significance(16);
    std::vector<double> totals = totalsOf(truth);
    EXPECT_GT(test::sameMeanPValue(totalsOf(found), totals), level);
    for (double& value : totals) value *= 1.04;
    EXPECT_LT(test::sameMeanPValue(totalsOf(found), totals), level);
}

// What is too heavy for the dark pixels of some rows is not for the bright ones of others.
TEST(NeighborReuse, ChangesNoMeanOfPixelsThatReuseTogether) {
    for (const Told& told : {tells(0, 200), tellsOther()}) {
        SCOPED_TRACE(told.name);
        const PixelSums mis = sumPixels("mis", told, 128, 5000, 100, true);
        for (const std::uint32_t raysOfRow : {1u, 2u}) {
            const PixelSums cache = sumPixels("cache", told, 4, 20000, 100, false, raysOfRow);
            expectSameTotal(cache.dark, mis.dark);
            expectSameTotal(cache.bright, mis.bright);
        }
    }
}

// Rows of their own are the control.
TEST(NeighborReuse, LessensTheNoiseOfPixelsWhoseRowsReuseTogether) {
    const PixelSums together = sumPixels("cache", tells(0, 200), 4, 4000, kDark, false);
    const PixelSums apart = sumPixels("cache", tells(0, 200), 4, 4000, kDark, true);
    EXPECT_LT(together.variance(), apart.variance() / 2);
    // One direction now adds to several camera rays of a pixel, whose spread does not show it.
    EXPECT_GT(together.covariance, together.ownVariance);
    EXPECT_LT(apart.covariance, 1e-3 * apart.ownVariance);  // control
}

/// Variance of a pixel with four times the camera rays asked for, which are two; other pixels
/// beside it have these.
///
/// @param raysOfRow  of that pixel
double noiseOfExtraRays(std::uint32_t raysOfRow) {
    constexpr std::uint32_t kExtraRays = 8;
    const Slit slit(tells(0, 200));
    const auto estimator =
        findEstimator("cache").make({slit.scene, slit.environment, &slit.cache.cache(), {}});
    const auto workspace = estimator->makeWorkspace();
    std::vector<ShadingPoint> points = floorPoints(slit.scene);
    for (std::uint32_t i = 0; i < kPoints; ++i) {
        ShadingPoint& point = points[i];
        const bool extra = i < kExtraRays;
        point.slot.pixel = extra ? 0 : 1 + (i - kExtraRays) / 2;
        point.slot.cameraRay = extra ? i : i % 2;
        point.slot.row = extra ? i / raysOfRow : i % 2;
        point.slot.sampleFraction = extra ? 0.25f : 1.0f;
        point.slot.errorScale = 100;  // too bright for reuse by all rows
    }
    test::Estimates pixel;
    for (std::uint64_t k = 0; k < 4000; ++k) {
        for (ShadingPoint& point : points) point.slot.seed = hashWords(k, point.slot.pixel);
        PointBatch batch{points, 4, 1 + (kPoints - kExtraRays) / 2, kExtraRays};
        std::vector<Estimate> found(kPoints);
        estimator->estimate(batch, *workspace, found);
        double sum = 0;
        for (std::size_t i = 0; i < kExtraRays; ++i)
            sum += static_cast<double>(found[i].irradiance.y);
        pixel.color[1].push_back(sum / kExtraRays);
    }
    return pixel.sampleVariance(1);
}

// Extra rays in rows of their own, where nobody else finds what they see, are the control.
TEST(NeighborReuse, OfExtraCameraRaysIsWithThoseOfOtherPixels) {
    EXPECT_LT(noiseOfExtraRays(4), noiseOfExtraRays(1) / 2);
}

/// The bake of `mesh` but for the base cell around `direction`, all of which counts as occluded.
BakeResult bakeHiding(const TriangleMesh& mesh, const Vec3d& direction) {
    BakeResult result = bakeOf(mesh);
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
    for (const test::Estimates& e :
         run(irradianceOf, *estimator, floorPoints(scene), samples, 400, true))
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
