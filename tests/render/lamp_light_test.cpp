// Light of lamps without a surface: a cache changes no mean; lobes meet soft lamps once; a lamp in
// a sphere shows the sum of its albedo's powers; counts are those of lamps that did not move.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/base/hash.h"
#include "common/emitters/lit_cap.h"
#include "render/frame/integrator.h"
#include "render/library/lit_stage.h"
#include "tests/support/glossy_reference.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

Image darkSky() {
    return test::constantMap(Rgb(0, 0, 0));
}

Lamp bulb(const Vec3d& position, double radius, float strength) {
    Lamp lamp;
    lamp.strength = Rgb(strength, 2 * strength, 3 * strength);
    lamp.position = position;
    lamp.radius = radius;
    return lamp;
}

/// A floor and a box under lamps of all forms, which light some of it.
TriangleMesh underLamps() {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addBox(mesh, {-0.5f, 0.3f, -0.5f}, {0.5f, 0.8f, 0.5f});
    mesh.lamps = {bulb({0.2, 1.2, 0.3}, 0.15, 1), bulb({-1.5, 0.5, 0}, 0, 0.5)};
    Lamp spot = bulb({1.5, 1.5, 1}, 0.1, 3);
    spot.direction = Vec3d(-0.5, -1, -0.5).normalized();
    spot.cone = LampCone{std::cos(0.3), std::cos(0.6), true};
    mesh.lamps.push_back(spot);
    Lamp sun = bulb(Vec3d(0), 0, 0.3f);
    sun.form = Lamp::Form::sun;
    sun.direction = Vec3d(0.6, -1, 0.2).normalized();
    sun.angle = 0.2;
    mesh.lamps.push_back(sun);
    Lamp area = bulb({0, 1, -1.5}, 0, 1);
    area.form = Lamp::Form::ellipse;
    area.direction = Vec3d(0, -1, 0);
    area.halfWidth = Vec3d(0.4, 0, 0);
    area.halfHeight = Vec3d(0, 0, 0.2);
    mesh.lamps.push_back(area);
    area.position = Vec3d(1.2, 0.9, -1);
    area.spread = 1.2;
    mesh.lamps.push_back(area);
    return mesh;
}

/// Means of small pictures by some seeds.
std::vector<double> meansOf(const test::World& world, const char* estimator, bool cache,
                            int bounces, const Camera& camera, std::uint64_t seeds,
                            const PlainLook& plain = {}) {
    LightingOptions lighting;
    lighting.bounces = bounces;
    lighting.plain = plain;
    LitStage lit(world.scene, cache ? &world.cache.cache() : nullptr, findEstimator(estimator),
                 lighting);
    lit.setEnvironment(world.environment);
    RenderOptions render;
    render.width = render.height = 12;
    render.cameraRays = render.samples = 4;
    render.bounces = bounces;
    render.plain = plain;
    std::vector<double> means;
    for (render.seed = 1; render.seed <= seeds; ++render.seed) {
        RenderStats stats;
        const Film film = lit.plan(camera, 1, render, stats).film(stats);
        double sum = 0;
        for (const Pixel& pixel : film.pixels) sum += static_cast<double>(pixel.color.y);
        means.push_back(sum / static_cast<double>(film.pixels.size()));
    }
    return means;
}

class UnderLamps : public testing::Test {
protected:
    const test::World world_{underLamps(), darkSky(), {.spacing = 0.25}};
};

TEST_F(UnderLamps, ACacheChangesNoMean) {
    const Camera camera = lookAt({0, 2, 3}, {0, 0.2, 0}, {0, 1, 0}, 0.9);
    const PlainLook gloss{.gloss = Gloss{.metallic = 0.5f, .roughness = 0.2f}};
    double least = 1, leastOfControl = 1;
    for (const PlainLook& plain : {PlainLook{}, gloss})
        for (const int bounces : {0, 2}) {
            const auto with = meansOf(world_, "cache", true, bounces, camera, 40, plain);
            const auto without = meansOf(world_, "mis", false, bounces, camera, 40, plain);
            least = std::min(least, test::sameMeanPValue(with, without));
            std::vector<double> brighter = with;
            for (double& mean : brighter) mean *= 1.03;
            leastOfControl = std::min(leastOfControl, test::sameMeanPValue(brighter, without));
        }
    EXPECT_GT(4 * least, test::significance(4));
    EXPECT_LT(leastOfControl, test::significance(4));
}

TEST_F(UnderLamps, KnowsThoseThatStandWhereTheyStood) {
    EXPECT_TRUE(world_.light->knowsAll());
    TriangleMesh other = underLamps();
    other.lamps[0].strength = Rgb(7, 0, 0);
    other.lamps[2].gain = Rgb(0, 0, 0);
    const Scene recoloured(other);
    EXPECT_TRUE(SetLight::of(recoloured, &world_.cache.cache())->knowsAll());
    other.lamps[1].position.x += 0.01;
    const Scene moved(other);
    EXPECT_FALSE(SetLight::of(moved, &world_.cache.cache())->knowsAll());
}

/// Expects what a stage says of lamps that a cache does not count, and why it refuses a preview.
void expectUncounted(const TriangleMesh& mesh, const test::TestCache& cache,
                     const std::string& what, const std::string& wanted) {
    const Scene scene(mesh);
    const LitStage lit(scene, &cache.cache(), findEstimator("cache"), {}, "a.vdb");
    EXPECT_EQ(lit.note(), "lamps: the cache " + what + "; unbiased, but noisier");
    RenderOptions preview;
    preview.samples = 0;
    test::expectError([&] { lit.requirePrediction(preview); },
                      "a.vdb: " + what + "; a preview is made of these counts: ", wanted);
}

TEST_F(UnderLamps, AreNamedWhereTheyWereMoved) {
    TriangleMesh other = underLamps();
    other.lamps[1].name = "desk";
    other.lamps[1].position.x += 0.01;
    expectUncounted(other, world_.cache,
                    "does not count 'desk' where it is: it was moved, reshaped or added since the "
                    "bake",
                    "bake the set as it stands now");
    other.lamps.push_back(bulb({1, 1, 1}, 0, 1));
    expectUncounted(other, world_.cache,
                    "does not count 2 of 7 emitters where they are, first 'desk': they were moved, "
                    "reshaped or added since the bake",
                    "bake the set as it stands now");
    other = underLamps();
    other.lamps[0].radius = 0.2;
    expectUncounted(other, world_.cache,
                    "does not count an emitter without a name where it is: it was moved, reshaped "
                    "or added since the bake",
                    "bake the set as it stands now");
}

TEST_F(UnderLamps, AreToldFromLampsThatWereNotBaked) {
    expectUncounted(underLamps(),
                    test::World(underLamps(), darkSky(), {.spacing = 0.25, .lamps = false}).cache,
                    "counts no emitters: it was baked with --no-lamps, before the set had any, or "
                    "by a program that counted none",
                    "bake without --no-lamps");
}

TEST(ManyLamps, ShareANameWhereTheyShareACount) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    for (int k = 0; k < 64; ++k) {
        mesh.lamps.push_back(bulb({0.05 * k, 1, 0}, 0, 1));
        mesh.lamps.back().name = "bulb " + std::to_string(k);
    }
    const test::World world(mesh, darkSky(), {.spacing = 1});
    mesh.lamps.back().position.y = 1.001;
    const Scene scene(mesh);
    const LitStage lit(scene, &world.cache.cache(), findEstimator("cache"), {});
    EXPECT_NE(lit.note().find("' or a neighbour that shares its count where it is"),
              std::string::npos)
        << lit.note();
}

TEST(EmissiveMaterial, IsNamedWhereItsSurfaceWasMoved) {
    const auto glowing = [](float height) {
        TriangleMesh mesh;
        test::addFloor(mesh, height, -1, 1, -1, 1);
        Material material;
        material.name = "screen";
        material.finish.emission = Rgb(1.0f);
        mesh.materials = {material};
        mesh.parts = {{0, static_cast<std::uint32_t>(mesh.triangles.size()), 0}};
        return mesh;
    };
    const test::World world(glowing(0), darkSky(), {.spacing = 1});
    expectUncounted(glowing(0.01f), world.cache,
                    "does not count 'screen' where it is: it was moved, reshaped or added since "
                    "the bake",
                    "bake the set as it stands now");
}

/// What a lobe reflects of a disc overhead that fills a cone, by a grid of directions.
double reflected(const GlossyLobe& lobe, const Vec3d& way, double radius, double intensity) {
    const double squared = way.length2(),
                 sineSquared = radius * radius / (squared + radius * radius);
    if (radius == 0)
        return intensity / squared * static_cast<double>(lobe.value(Vec3f(way.normalized())).y);
    constexpr int kSide = 400;
    double sum = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
        const int column = i % kSide, row = i / kSide;
        const Vec3d w =
            sampleCap(way.normalized(), sineSquared, (column + 0.5) / kSide, (row + 0.5) / kSide);
        sum += static_cast<double>(lobe.value(Vec3f(w)).y) / (kSide * kSide);
    }
    return sum * capSolidAngle(sineSquared) * intensity / (kPi * radius * radius);
}

// By rays to lamps and rays of the lobe: nothing is met twice, and nothing is left out.
TEST(LampGloss, IsTheIntegralOverTheLamp) {
    double least = 1, leastOfControl = 1;
    int tests = 0;
    for (const double radius : {0.0, 0.1, 0.6})
        for (const float roughness : {0.1f, 0.4f}) {
            TriangleMesh mesh;
            test::addFloor(mesh, 0, -2, 2, -2, 2);
            mesh.lamps = {bulb({0.6, 0.9, 0.1}, radius, 1)};
            const test::World world(mesh, darkSky());
            const ShadingPoint point = test::pointAlong(world.scene, {0, 1, 0}, {0, -1, 0});
            const Surface surface = glossy(Rgb(1), Gloss{.metallic = 1, .roughness = roughness});
            const GlossyLobe lobe(surface, point.place.normal, Vec3f(-0.6f, 0.8f, 0));
            const double truth =
                reflected(lobe, mesh.lamps[0].position - Vec3d(point.place.rayOrigin), radius, 2);
            const auto estimator = findEstimator("cache").make(world.context(), {});
            const std::vector<double> found = test::reflectedBySeeds(*estimator, point, lobe, 300);
            if (radius == 0) {
                // One direction, which only rays to the lamp find.
                for (const double value : found) EXPECT_NEAR(value / truth, 1, 1e-3);
                continue;
            }
            ++tests;
            least = std::min(least, test::meanPValue(found, truth));
            leastOfControl = std::min(leastOfControl, test::meanPValue(found, truth * 1.05));
        }
    EXPECT_GT(tests * least, test::significance(4));
    EXPECT_LT(leastOfControl, test::significance(4));
}

/// Light that a place gets from an area, before which a ceiling may stand.
///
/// @param turned    columns: across the ceiling, to the place, and along it
/// @param distance  of the ceiling before the area; none: there is none
double lightUnderCeiling(const std::array<Vec3d, 3>& turned, const Vec3d& middle, double extent,
                         std::optional<double> distance) {
    TriangleMesh mesh;
    const auto at = [&](double x, double y, double z) {
        return Vec3f(middle + turned[0] * x + turned[1] * y + turned[2] * z);
    };
    test::addQuad(mesh, at(-1, 2, -1), at(-1, 2, 1), at(1, 2, 1), at(1, 2, -1));
    if (distance)
        test::addQuad(mesh, at(-extent, *distance, -extent), at(-extent, *distance, extent),
                      at(extent, *distance, extent), at(extent, *distance, -extent));
    Lamp area = bulb(middle, 0, 1);
    area.form = Lamp::Form::rectangle;
    area.direction = turned[1];
    area.halfWidth = turned[0] * 0.4;
    area.halfHeight = turned[2] * 0.3;
    mesh.lamps = {area};
    const test::World world(std::move(mesh), darkSky());
    const ShadingPoint point = test::pointAlong(world.scene, at(0.2, 1, 0.1), Vec3f(turned[1]));
    const auto estimator = findEstimator("mis").make(world.context(), {});
    return test::runEstimator(*estimator, point, 8, 30).mean(1);
}

// Cycles' users put them there. The control is a ceiling a millimetre before them.
TEST(AreaLamp, ShinesInThePlaneOfItsCeiling) {
    for (std::uint64_t k = 0; k < 8; ++k) {
        const auto unit = [&](std::uint64_t n) { return 2 * toUnit(hashWords(k, n)) - 1; };
        const Vec3d down = Vec3d(unit(1), unit(2), unit(3)).normalized();
        const Vec3d across = down.cross(Vec3d(unit(4), unit(5), unit(6))).normalized();
        const std::array<Vec3d, 3> turned{across, down, across.cross(down)};
        const Vec3d middle = Vec3d(unit(7), unit(8), unit(9)) * std::pow(10.0, 1.5 * unit(10));
        const double extent = 2 + 8 * std::abs(unit(11));
        const double open = lightUnderCeiling(turned, middle, extent, {});
        EXPECT_GT(lightUnderCeiling(turned, middle, extent, 0.0), 0.9999 * open) << k;
        EXPECT_LT(lightUnderCeiling(turned, middle, extent, 0.001), 1e-6 * open) << k;
    }
}

/// An area with a spread over a floor.
TriangleMesh underSpread(double spread) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    Lamp area = bulb({0.1, 1, 0.2}, 0, 1);
    area.form = Lamp::Form::rectangle;
    area.direction = Vec3d(0.1, -1, 0).normalized();
    area.halfWidth = Vec3d(0, 0, 0.3);
    area.halfHeight = area.direction.cross(Vec3d(0, 0, 0.2));
    area.spread = spread;
    mesh.lamps = {area};
    return mesh;
}

/// Calls visit(direction, green light from there by solid angle) for all parts of an area.
template <class Visit>
void overArea(const Lamp& lamp, const Vec3d& place, const Visit& visit) {
    constexpr int kSide = 1000;
    for (int i = 0; i < kSide * kSide; ++i) {
        const int column = i % kSide, row = i / kSide;
        const Vec3d way = lamp.position + lamp.halfWidth * ((column + 0.5) * 2 / kSide - 1) +
                          lamp.halfHeight * ((row + 0.5) * 2 / kSide - 1) - place;
        const Vec3d w = way.normalized();
        const double cosine = -lamp.direction.dot(w), angle = std::acos(std::min(1.0, cosine));
        const double left = std::max(0.0, 1 - std::tan(angle) / std::tan(0.5 * lamp.spread));
        visit(w, static_cast<double>(lamp.strength.y) * left * cosine /
                     (way.length2() * kSide * kSide));
    }
}

// By every estimator that lights sets, with a control.
TEST(LampWithASpread, LightsByItsIntegral) {
    constexpr double kSpreads[] = {0.2, 1.5};
    double least = 1, leastOfControl = 1;
    int tests = 0;
    for (const double spread : kSpreads) {
        const test::World world(underSpread(spread), darkSky());
        const ShadingPoint point = test::pointAlong(world.scene, {0.2f, 0.5f, 0.25f}, {0, -1, 0});
        double truth = 0;
        overArea(world.mesh.lamps[0], Vec3d(point.place.rayOrigin),
                 [&](const Vec3d& w, double light) { truth += light * std::max(0.0, w.y); });
        const auto green = static_cast<float>(truth);
        const Rgb expected(green / 2, green, green * 1.5f);
        for (const EstimatorEntry& entry : estimatorTable()) {
            if (!entry.lit) continue;
            const auto estimator = entry.make(world.context(), {});
            const test::Estimates found = test::runEstimator(*estimator, point, 8, 400);
            least = std::min(least, test::agreementPValue(found, expected));
            leastOfControl =
                std::min(leastOfControl, test::agreementPValue(found, expected * 1.05f));
            ++tests;
        }
    }
    EXPECT_GT(tests * least, test::significance(2));
    EXPECT_LT(leastOfControl, test::significance(2));
}

TEST(LampWithASpread, IsReflectedByItsIntegral) {
    double least = 1, leastOfControl = 1;
    const test::World world(underSpread(0.5), darkSky());
    const ShadingPoint point = test::pointAlong(world.scene, {0.2f, 0.5f, 0.25f}, {0, -1, 0});
    const auto estimator = findEstimator("cache").make(world.context(), {});
    for (const float roughness : {0.15f, 0.5f}) {
        const Surface surface = glossy(Rgb(1), Gloss{.metallic = 1, .roughness = roughness});
        const GlossyLobe lobe(surface, point.place.normal, Vec3f(-0.1f, 1, 0.1f).normalized());
        double truth = 0;
        overArea(world.mesh.lamps[0], Vec3d(point.place.rayOrigin),
                 [&](const Vec3d& w, double light) {
                     if (light > 0) truth += light * static_cast<double>(lobe.value(Vec3f(w)).y);
                 });
        const std::vector<double> found = test::reflectedBySeeds(*estimator, point, lobe, 1000);
        least = std::min(least, test::meanPValue(found, truth));
        leastOfControl = std::min(leastOfControl, test::meanPValue(found, truth * 1.05));
    }
    EXPECT_GT(2 * least, test::significance(2));
    EXPECT_LT(leastOfControl, test::significance(2));
}

// Inside of a sphere around a lamp: albedo / pi I / r^2 times the sum of albedo^k, k = 0 to B.
TEST(LampInASphere, ShowsAGeometricSum) {
    constexpr double kAlbedo = 0.5;
    TriangleMesh mesh;
    test::addSphere(mesh, {0, 0, 0}, 1, 40);
    mesh.lamps = {bulb({0, 0, 0}, 0.05, 1)};
    const test::World world(mesh, darkSky(), {.spacing = 0.25});
    const Camera camera = lookAt({0.5, 0.2, 0.3}, {-0.3, 0.1, -0.4}, {0, 1, 0}, 1.2);
    for (const bool cache : {false, true})
        for (int bounces = 0; bounces <= 3; ++bounces) {
            double truth = 0;
            for (int k = 0; k <= bounces; ++k) truth += 2 * kAlbedo / kPi * std::pow(kAlbedo, k);
            const auto found = meansOf(world, cache ? "cache" : "mis", cache, bounces, camera, 8);
            double mean = 0;
            for (const double value : found) mean += value / static_cast<double>(found.size());
            EXPECT_NEAR(mean / truth, 1, 0.02) << cache << " " << bounces;
        }
}

}  // namespace
}  // namespace shadowcache
