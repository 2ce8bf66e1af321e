// What glossy surfaces reflect, by the estimators: against a white furnace and brute force.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/glossy_reference.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

using test::GlossyLook;

/// A direction to the viewer at `cosine` to the point's normal.
Vec3f viewerAt(const ShadingPoint& point, double cosine) {
    Vec3d s, t;
    tangentFrame(Vec3d(point.place.normal), s, t);
    return Vec3f(Vec3d(point.place.normal) * cosine +
                 (s * 0.8 + t * 0.6) * std::sqrt(1 - cosine * cosine));
}

/// Estimates of what a look reflects, both of its parts, with the seeds 1 .. count; and of the
/// glossy part alone.
struct Reflections {
    test::Estimates whole, glossy;
};

Reflections reflect(const Estimator& estimator, ShadingPoint point, const GlossyLook& look,
                    const Vec3f& toViewer, int samples, int count) {
    const Surface surface = shadowcache::glossy(look.baseColor, look.gloss);
    const GlossyLobe lobe(surface, point.place.normal, toViewer);
    const Rgb diffuse =
        diffuseAlbedo(surface, point.place.normal.dot(toViewer)) * static_cast<float>(1 / kPi);
    const auto workspace = estimator.makeWorkspace();
    Reflections result;
    for (int k = 1; k <= count; ++k) {
        point.slot.seed = hashWords(static_cast<std::uint64_t>(k));
        PointBatch batch{{&point, 1}, samples};
        Estimate e;
        estimator.estimate(batch, *workspace, {&e, 1});
        const GlossyPoint glossy{point, lobe};
        GlossEstimate g;
        estimator.estimateGloss(batch, {&glossy, 1}, *workspace, {&g, 1});
        const Rgb sum = diffuse * e.irradiance + g.radiance;
        for (int c = 0; c < 3; ++c) {
            result.whole.color[static_cast<std::size_t>(c)].push_back(static_cast<double>(sum[c]));
            result.glossy.color[static_cast<std::size_t>(c)].push_back(
                static_cast<double>(g.radiance[c]));
        }
        result.glossy.variance.push_back(static_cast<double>(g.variance));
    }
    return result;
}

// A white sky shows a surface's own albedo. With its control: one per cent more is not it.
TEST(GlossyLight, OfAWhiteFurnaceIsTheAlbedo) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -1, 1, -1, 1);
    const test::World world(mesh, test::constantMap(Rgb(1, 1, 1)));
    const auto estimator = findEstimator("mis").make(world.context(), {});
    const ShadingPoint point = world.below();
    const std::vector<double> cosines{1, 0.6, 0.15};
    const double level = test::significance(test::glossyLooks().size() * cosines.size());
    for (const GlossyLook& look : test::glossyLooks())
        for (const double cosine : cosines) {
            const Rgb truth(test::referenceAlbedo(look, cosine));
            const test::Estimates found =
                reflect(*estimator, point, look, viewerAt(point, cosine), 64, 2000).whole;
            EXPECT_GT(test::agreementPValue(found, truth), level)
                << look.gloss.roughness << " at " << cosine << ": mean " << found.mean(1)
                << ", wanted " << truth.y;
            EXPECT_LT(test::agreementPValue(found, truth * 1.01f), level)
                << look.gloss.roughness << " at " << cosine;
        }
}

/// Sample counts and how many estimates of each are averaged.
struct GlossRuns {
    int samples, count;
};
constexpr GlossRuns kGlossRuns[] = {{1, 6000}, {3, 4000}, {64, 3000}};

// All estimators but `cache` share one: the same bits.
TEST(GlossyLight, IsOneForAllEstimators) {
    const test::World world(test::slabMesh(), test::noiseMap(64, 32, 7));
    const ShadingPoint point = world.below();
    const GlossyLook look = test::glossyLooks()[3];
    const auto estimatesOf = [&](const Estimator& estimator) {
        return reflect(estimator, point, look, viewerAt(point, 0.5), 5, 3).glossy.color;
    };
    const auto wanted = estimatesOf(*findEstimator("mis").make(world.context(), {}));
    for (const auto& [name, estimator] : test::everyEstimator(world.context()))
        if (name != "cache") {
            EXPECT_EQ(estimatesOf(*estimator), wanted) << name;
        }
}

class GlossyReflection : public testing::TestWithParam<std::size_t> {};

INSTANTIATE_TEST_SUITE_P(Looks, GlossyReflection, testing::Range<std::size_t>(0, 5));

// Beside a slab that hides a part of a map with bright and dark places. With its control: 3 % more
// is rejected with 64 samples.
TEST_P(GlossyReflection, IsBruteForces) {
    const GlossyLook look = test::glossyLooks()[GetParam()];
    const test::World world(test::slabMesh(), test::noiseMap(64, 32, 7));
    const ShadingPoint point = world.below();
    const Vec3f viewer = viewerAt(point, 0.5);
    const Rgb truth =
        test::tracedReflection(world.scene, point, look, Vec3d(viewer), world.environment);
    const std::vector<std::string> names{"mis", "cache"};
    const double level = test::significance(names.size() * std::size(kGlossRuns));
    for (const std::string& name : names)
        for (const GlossRuns& runs : kGlossRuns) {
            const auto estimator = findEstimator(name).make(world.context(), {});
            const test::Estimates found =
                reflect(*estimator, point, look, viewer, runs.samples, runs.count).whole;
            EXPECT_GT(test::agreementPValue(found, truth), level)
                << name << ", " << runs.samples << " samples: mean " << found.mean(1) << ", wanted "
                << truth.y;
            if (runs.samples < 64) continue;
            EXPECT_LT(test::agreementPValue(found, truth * 1.03f), level) << name;
        }
}

// The control is the factor itself: noise is not told twice or half.
TEST(GlossyLight, TellsItsVariance) {
    const test::World world(test::slabMesh(), test::noiseMap(64, 32, 7));
    const auto estimator = findEstimator("mis").make(world.context(Sequence::kRandom), {});
    const ShadingPoint point = world.below();
    const GlossyLook look = test::glossyLooks()[2];
    const test::Estimates found =
        reflect(*estimator, point, look, viewerAt(point, 0.5), 64, 2000).glossy;
    double told = 0;
    for (const double variance : found.variance) told += variance / 2000;
    test::Estimates luminances = found;
    for (std::size_t k = 0; k < luminances.color[0].size(); ++k)
        luminances.color[0][k] = static_cast<double>(world.environment.luminance(
            Rgb(static_cast<float>(found.color[0][k]), static_cast<float>(found.color[1][k]),
                static_cast<float>(found.color[2][k]))));
    EXPECT_NEAR(told / luminances.sampleVariance(0), 1, 0.2);
}

// A mirror shows the sky.
TEST(GlossyLight, OfAMirrorIsTheMapsTexel) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -1, 1, -1, 1);
    const Image map = test::noiseMap(16, 8, 3);
    const test::World world(mesh, map);
    const ShadingPoint point = world.below();
    const Vec3f viewer = viewerAt(point, 0.7);
    const Vec3f mirrored = point.place.normal * (2 * point.place.normal.dot(viewer)) - viewer;
    const GlossyLook mirror{Rgb(1, 1, 1), {.metallic = 1, .roughness = 0}};
    const auto estimator = findEstimator("mis").make(world.context(), {});
    const test::Estimates found = reflect(*estimator, point, mirror, viewer, 64, 100).whole;
    const Rgb wanted = world.environment.radiance(mirrored);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found.mean(c) / static_cast<double>(wanted[c]), 1, 0.01);
}

TEST(GlossyLight, WithoutLightIsBlack) {
    const test::World night(test::slabMesh(), test::constantMap(Rgb(0, 0, 0)));
    const ShadingPoint point = night.below();
    const auto estimator = findEstimator("cache").make(night.context(), {});
    for (const int samples : {0, 4}) {
        const test::Estimates found =
            reflect(*estimator, point, test::glossyLooks()[0], viewerAt(point, 0.7), samples, 20)
                .glossy;
        for (int c = 0; c < 3; ++c) EXPECT_EQ(found.mean(c), 0);
    }
}

// Without samples `cache` shows what it predicts, without noise; `mis` has no prediction.
TEST(GlossyLight, WithoutSamplesIsPredictedByTheCache) {
    const test::World world(test::slabMesh(), test::noiseMap(64, 32, 7));
    const ShadingPoint point = world.below();
    const Vec3f viewer = viewerAt(point, 0.7);
    for (const float roughness : {0.2f, 0.3f, 0.6f}) {
        const GlossyLook look{Rgb(0.9f, 0.7f, 0.3f), {.metallic = 1, .roughness = roughness}};
        const Rgb truth =
            test::tracedReflection(world.scene, point, look, Vec3d(viewer), world.environment);
        const auto cache = findEstimator("cache").make(world.context(), {});
        const auto mis = findEstimator("mis").make(world.context(), {});
        const test::Estimates found = reflect(*cache, point, look, viewer, 0, 2).glossy;
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(found.mean(c) / static_cast<double>(truth[c]), 1, 0.05) << roughness;
            EXPECT_EQ(found.sampleVariance(c), 0);
            EXPECT_EQ(reflect(*mis, point, look, viewer, 0, 2).glossy.mean(c), 0);
        }
    }
}

}  // namespace
}  // namespace shadowcache
