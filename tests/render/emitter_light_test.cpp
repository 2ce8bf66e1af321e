// Light of emitters: small, large and near lamps by their closed form; none of a lamp in a closed
// shade; a closed box shows the sum of its albedo's powers; lobes meet nothing twice; counts are
// those of lamps that did not move.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/hash.h"
#include "common/mesh/placed_mesh.h"
#include "render/frame/integrator.h"
#include "render/library/lit_stage.h"
#include "tests/support/glossy_reference.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

/// The triangles from `first` on shine.
void makeShine(TriangleMesh& mesh, std::size_t first, const Rgb& radiance, bool twoSided = true) {
    const auto begin = static_cast<std::uint32_t>(first);
    const auto end = static_cast<std::uint32_t>(mesh.triangles.size());
    Material dark, lamp;
    dark.albedo = lamp.albedo = Rgb(0.5f);
    lamp.finish.emission = radiance;
    lamp.doubleSided = twoSided;
    mesh.materials = {dark, lamp};
    mesh.parts.clear();
    if (begin > 0) mesh.parts.push_back({0, begin, 0});
    mesh.parts.push_back({begin, end - begin, 1});
}

/// A floor under a square lamp that looks down.
TriangleMesh lampOver(float height, float half) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addQuad(mesh, {-half, height, -half}, {half, height, -half}, {half, height, half},
                  {-half, height, half});
    makeShine(mesh, 2, Rgb(1, 2, 3));
    return mesh;
}

Image night() {
    return test::constantMap(Rgb(0, 0, 0));
}

/// Irradiance by a radiance of 1 of the triangles from `first` on, at a point.
double unoccluded(const TriangleMesh& mesh, std::size_t first, const ShadingPoint& point) {
    double sum = 0;
    for (std::size_t i = first; i < mesh.triangles.size(); ++i) {
        const auto corners = placedCorners(mesh, static_cast<std::uint32_t>(i));
        sum += test::polygonIrradiance(Vec3d(point.place.rayOrigin), Vec3d(point.place.normal),
                                       corners);
    }
    return sum;
}

struct LampCase {
    std::string name;
    float height, half;
};

class LampOver : public testing::TestWithParam<LampCase> {};

TEST_P(LampOver, LightsTheFloorByItsClosedForm) {
    const test::World world(lampOver(GetParam().height, GetParam().half), night());
    const ShadingPoint point = test::pointAlong(world.scene, {0.3f, 0.0005f, 0.2f}, {0, -1, 0});
    const double truth = unoccluded(world.mesh, 2, point);
    const Rgb expected(static_cast<float>(truth), static_cast<float>(2 * truth),
                       static_cast<float>(3 * truth));
    double least = 1;
    for (const char* name : {"mis", "cache"}) {
        const auto estimator = findEstimator(name).make(world.context(), {});
        const test::Estimates found = test::runEstimator(*estimator, point, 8, 400);
        least = std::min(least, test::agreementPValue(found, expected));
        EXPECT_LT(test::agreementPValue(found, expected * 1.1f), test::significance(4))
            << "10 % more is accepted";
    }
    EXPECT_GT(2 * least, test::significance(4));
}

INSTANTIATE_TEST_SUITE_P(Sizes, LampOver,
                         testing::Values(LampCase{"small", 1, 0.0005f}, LampCase{"usual", 1, 0.2f},
                                         LampCase{"large", 1, 5}, LampCase{"near", 0.001f, 1}),
                         [](const auto& lamp) { return lamp.param.name; });

TEST(EmitterLight, IsNoneOfALampInAClosedShade) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addBox(mesh, {-0.4f, 0.8f, -0.4f}, {0.4f, 1.2f, 0.4f});
    const std::size_t first = mesh.triangles.size();
    test::addSphere(mesh, {0, 1, 0}, 0.1f, 4);
    makeShine(mesh, first, Rgb(100));
    const test::World world(mesh, night(), {.spacing = 0.25});
    const ShadingPoint point = world.below();
    for (const char* name : {"mis", "cache"}) {
        const auto estimator = findEstimator(name).make(world.context(), {});
        EXPECT_EQ(estimator->estimate(point, 16, *estimator->makeWorkspace()).irradiance,
                  Rgb(0.0f));
    }
    // The cache knows.
    EmitterLight::Tools tools(world.light->light());
    EXPECT_TRUE(world.light->knowsAll());
    EXPECT_EQ(world.light->light().predict(point.place, tools), Rgb(0.0f));
}

TEST(EmitterLight, IsPredictedByTheCache) {
    TriangleMesh mesh = lampOver(1, 0.3f);
    const test::World world(mesh, night(), {.spacing = 0.25});
    const ShadingPoint point = test::pointAlong(world.scene, {0.3f, 0.5f, 0.2f}, {0, -1, 0});
    EmitterLight::Tools tools(world.light->light());
    EXPECT_NEAR(static_cast<double>(world.light->light().predict(point.place, tools).x) /
                    unoccluded(mesh, 2, point),
                1, 0.02);
}

/// Estimates of one point under a lamp and of nine far from it, all as important.
std::vector<Estimate> litTogether(const test::World& world, float importance, std::uint64_t seed) {
    const auto estimator = findEstimator("mis").make(world.context(), {});
    std::vector<ShadingPoint> points;
    for (int i = 0; i < 10; ++i) {
        const float x = i == 0 ? 0.3f : 1.9f;
        points.push_back(
            test::pointAlong(world.scene, {x, 0.0005f, 0.1f * static_cast<float>(i)}, {0, -1, 0}));
        points.back().slot.seed = hashWords(seed, static_cast<std::uint64_t>(i));
        points.back().slot.pixel = static_cast<std::uint32_t>(i);
        points.back().slot.importance = importance;
    }
    std::vector<Estimate> estimates(points.size());
    estimator->estimate({.points = points, .pixels = 10}, *estimator->makeWorkspace(), estimates);
    return estimates;
}

TEST(EmitterLight, HasMostRaysWhereItCountsMost) {
    const test::World world(lampOver(0.5f, 0.05f), night());
    const std::vector<Estimate> found = litTogether(world, 1, 1), alike = litTogether(world, 0, 1);
    EXPECT_GE(found[0].rays, 8u);
    EXPECT_EQ(alike[0].rays, 1u);
    for (std::size_t i = 1; i < found.size(); ++i) EXPECT_EQ(found[i].rays, 1u);
    // More rays, not more light.
    const ShadingPoint point = test::pointAlong(world.scene, {0.3f, 0.0005f, 0}, {0, -1, 0});
    double sum = 0;
    constexpr int kSeeds = 200;
    for (int i = 0; i < kSeeds; ++i)
        sum += static_cast<double>(
                   litTogether(world, 1, static_cast<std::uint64_t>(i))[0].irradiance.x) /
               kSeeds;
    EXPECT_NEAR(sum / unoccluded(world.mesh, 2, point), 1, 0.01);
}

// A lamp that almost touches the middle of an item sends it no more than what all of it receives.
TEST(EmitterLight, OfAnItemIsThatOfItsSurface) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    const std::size_t first = mesh.triangles.size();
    test::addSphere(mesh, {0.25f, 0.02f, 0.25f}, 0.01f, 3);
    makeShine(mesh, first, Rgb(1000));
    const test::World world(mesh, night(), {.spacing = 0.5});
    const ItemTable items(world.cache.cache());
    double most = 0;
    for (const Rgb& light : world.light->predictItems(items))
        most = std::max(most, static_cast<double>(light.x));
    // Half of what the lamp sends, over the item's part of the floor.
    const double sent = 1000 * kPi * 4 * kPi * 0.01 * 0.01 / 2;
    EXPECT_GT(most, 0.1 * sent / (0.5 * 0.5));
    EXPECT_LT(most, 3 * sent / (0.5 * 0.5));
}

TEST(EmitterLight, KnowsLampsThatStandWhereTheyStood) {
    const test::World world(lampOver(1, 0.3f), night(), {.spacing = 0.25});
    TriangleMesh other = lampOver(1, 0.3f);
    other.materials[1].finish.emission = Rgb(7, 0, 0);
    const Scene recoloured(other);
    EXPECT_TRUE(SetLight::of(recoloured, &world.cache.cache())->knowsAll());
    const TriangleMesh lower = lampOver(0.9f, 0.3f);
    const Scene moved(lower);
    EXPECT_FALSE(SetLight::of(moved, &world.cache.cache())->knowsAll());
    TriangleMesh dark = lampOver(1, 0.3f);
    dark.materials[1].finish.emission = Rgb(0);
    const Scene off(dark);
    EXPECT_EQ(SetLight::of(off, &world.cache.cache()), nullptr);
}

TEST(EmitterLight, IsRefusedByEstimatorsWithoutIt) {
    const test::World world(lampOver(1, 0.3f), night());
    EXPECT_THROW(LitStage(world.scene, nullptr, findEstimator("paper"), {}), Error);
    EXPECT_NO_THROW(LitStage(world.scene, nullptr, findEstimator("mis"), {}));
}

/// The inside of a box whose walls emit 1.
class ClosedBox : public testing::Test {
protected:
    static constexpr double kAlbedo = 0.5;

    ClosedBox() {
        TriangleMesh mesh;
        test::addBox(mesh, {-1, -1, -1}, {1, 1, 1});
        makeShine(mesh, 0, Rgb(1));
        world_.emplace(mesh, night(), BakeOptions{.spacing = 0.25});
    }

    /// Mean radiance over a small picture for some seeds.
    std::vector<double> means(const char* estimator, bool cache, int bounces) {
        LightingOptions options;
        options.bounces = bounces;
        LitStage lit(world_->scene, cache ? &world_->cache.cache() : nullptr,
                     findEstimator(estimator), options);
        lit.setEnvironment(world_->environment);
        RenderOptions render;
        render.width = render.height = 8;
        render.cameraRays = 4;
        render.samples = 4;
        render.bounces = bounces;
        std::vector<double> means;
        for (std::uint64_t seed = 1; seed <= 24; ++seed) {
            render.seed = seed;
            RenderStats stats;
            const Camera camera = lookAt({0.5, 0.2, 0.7}, {-0.3, 0.1, -0.4}, {0, 1, 0}, 1.2);
            const Film film = lit.plan(camera, 1, render, stats).film(stats);
            double sum = 0;
            for (const Pixel& pixel : film.pixels) sum += static_cast<double>(pixel.color.y);
            means.push_back(sum / static_cast<double>(film.pixels.size()));
        }
        return means;
    }

    std::optional<test::World> world_;
};

// Radiance of the walls after B bounces: sum of albedo^k, k = 0 to B + 1.
TEST_F(ClosedBox, ShowsAGeometricSum) {
    double least = 1, leastOfControl = 1;
    for (const bool cache : {false, true})
        for (int bounces = 0; bounces <= 5; ++bounces) {
            double truth = 0;
            for (int k = 0; k <= bounces + 1; ++k) truth += std::pow(kAlbedo, k);
            const std::vector<double> found = means(cache ? "cache" : "mis", cache, bounces);
            least = std::min(least, test::meanPValue(found, truth));
            leastOfControl = std::min(leastOfControl, test::meanPValue(found, truth * 1.02));
        }
    EXPECT_GT(12 * least, test::significance(12));
    EXPECT_LT(leastOfControl, test::significance(12));
}

// By rays to emitters and rays of the lobe: nothing is met twice, and nothing is left out.
TEST_F(ClosedBox, ShowsTheAlbedoOfALobe) {
    const ShadingPoint point = test::pointAlong(world_->scene, {0.2f, 0, 0.1f}, {0, -1, 0});
    const auto estimator = findEstimator("cache").make(world_->context(), {});
    double least = 1, leastOfControl = 1;
    for (const float roughness : {0.05f, 0.3f, 0.8f}) {
        const Surface surface = glossy(Rgb(1), Gloss{.metallic = 1, .roughness = roughness});
        const GlossyLobe lobe(surface, point.place.normal, Vec3f(0.6f, 0.8f, 0));
        double truth = 0;
        constexpr int kSide = 300;
        for (int i = 0; i < kSide * kSide; ++i) {
            const int column = i % kSide, row = i / kSide;
            const Vec3f w = lobe.sample((static_cast<float>(column) + 0.5f) / kSide,
                                        (static_cast<float>(row) + 0.5f) / kSide);
            if (w.dot(point.place.geometricNormal) > 0 && lobe.density(w) > 0)
                truth += static_cast<double>(lobe.value(w).y / lobe.density(w)) / (kSide * kSide);
        }
        const std::vector<double> found = test::reflectedBySeeds(*estimator, point, lobe, 400);
        least = std::min(least, test::meanPValue(found, truth));
        leastOfControl = std::min(leastOfControl, test::meanPValue(found, truth * 1.02));
    }
    EXPECT_GT(3 * least, test::significance(3));
    EXPECT_LT(leastOfControl, test::significance(3));
}

}  // namespace
}  // namespace shadowcache
