// The techniques that the paper compares: the biased ones against their definitions, the options of
// the others against closed forms.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "render/paper/convolution.h"
#include "tests/study/estimators/larcher_sequence.h"
#include "tests/study/estimators/light_clusters.h"
#include "tests/study/estimators/technique_table.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_scenes.h"

namespace shadowcache::study {
namespace {

const Rgb kSky(1, 0.5f, 2);

using test::floorMesh, test::slabMesh, test::World;

Rgb once(const World& world, const std::string& name, const ShadingPoint& point, int samples,
         const TechniqueOptions& options = {}) {
    const auto estimates =
        test::runEstimator(*makeEstimator(name, world.context(), options), point, samples, 1);
    return Rgb(Vec3d(estimates.mean(0), estimates.mean(1), estimates.mean(2)));
}

double relativeDifference(const Rgb& a, const Rgb& b) {
    double most = 0;
    for (int c = 0; c < 3; ++c)
        most = std::max(most, std::abs(static_cast<double>(a[c] / b[c]) - 1));
    return most;
}

// Control: one per cent more light is seen.
TEST(Preconvolved, IsTheIrradianceWhereNothingHides) {
    const Vec3d slope(0.3, -0.5, 0.6);
    const World world(floorMesh(), test::gradientMap(512, 256, slope));
    const ShadingPoint point = world.below();
    const Rgb truth(static_cast<float>(kPi + 2 * kPi / 3 * slope.dot(Vec3d(point.place.normal))));
    EXPECT_LT(relativeDifference(once(world, "preconvolved", point, 1), truth), 1e-4);
    EXPECT_GT(relativeDifference(once(world, "preconvolved", point, 1), truth * 1.01f), 1e-3);
    for (const char* name : {"ambient-occlusion", "ambient-occlusion-cached"})
        EXPECT_LT(relativeDifference(once(world, name, point, 16), truth), 1e-4) << name;
}

// Under lamps, where the irradiance has kinks. Control: the table of one map is not that of
// another.
TEST(Preconvolved, TableIsNextToTheExactSums) {
    const Environment environment = test::environmentOf(test::noiseMap(256, 128, 4));
    const Environment other = test::environmentOf(test::noiseMap(256, 128, 5));
    const IrradianceTable table(environment);
    double worst = 0, control = 0;
    for (std::uint32_t c = 0; c < cellCount(2); ++c) {
        const Vec3d n = cellCenter(2, c);
        const Rgb value = table.evaluate(Vec3f(n));
        worst = std::max(worst, relativeDifference(value, Rgb(mapIrradiance(environment, n))));
        control = std::max(control, relativeDifference(value, Rgb(mapIrradiance(other, n))));
    }
    EXPECT_LT(worst, 3e-3);
    EXPECT_GT(control, 1e-2);
}

TEST(Preconvolved, KnowsNoOccluder) {
    const World open(floorMesh(), test::constantMap(kSky));
    const World hidden(slabMesh(), test::constantMap(kSky));
    const Rgb a = once(open, "preconvolved", open.below(), 1);
    EXPECT_LT(relativeDifference(once(hidden, "preconvolved", hidden.below(), 1), a), 1e-6);
    EXPECT_LT(relativeDifference(a, kSky * static_cast<float>(kPi)), 1e-4);
}

// Ambient visibility is a share of solid angle: that of a slab endless along z is the share of
// azimuths about z that it leaves open. Control: the irradiance's share differs from it.
TEST(AmbientOcclusion, IsTheVisibleShareOfTheHemisphere) {
    TriangleMesh mesh = floorMesh();
    test::addBox(mesh, {0.5f, 1, -400}, {2, 1.5f, 400});
    const World world(std::move(mesh), test::constantMap(kSky));
    const ShadingPoint point = world.below();
    const double from = std::atan2(0.5, 1.5), to = std::atan2(2, 1);
    const double share = 1 - (to - from) / kPi;
    const Rgb truth = kSky * static_cast<float>(kPi * share);
    EXPECT_LT(relativeDifference(once(world, "ambient-occlusion", point, 65536), truth), 3e-3);
    EXPECT_LT(relativeDifference(once(world, "ambient-occlusion-cached", point, 0), truth), 0.03);
    const double lit = 1 - (std::sin(to) - std::sin(from)) / 2;
    EXPECT_GT(std::abs(lit / share - 1), 0.05);
}

// Control: with half of the map's radiance the sums differ.
TEST(Lights, HaveTheEnergyOfTheMap) {
    const Environment environment = test::environmentOf(test::noiseMap(64, 32, 3));
    Vec3d map(0.0);
    for (std::size_t i = 0; i < environment.texelCount(); ++i) {
        const Environment::Texel t = environment.texel(i);
        map += Vec3d(t.radiance) * static_cast<double>(t.solidAngle);
    }
    for (const int count : {1, 2, 40, 1000}) {
        const auto lights = clusterLights(environment, count);
        EXPECT_LE(lights.size(), static_cast<std::size_t>(count));
        EXPECT_GT(lights.size(), 0.8 * count);
        Vec3d sum(0.0);
        for (const DirectionalLight& light : lights) {
            sum += Vec3d(light.radianceIntegral);
            EXPECT_NEAR(static_cast<double>(light.direction.length()), 1, 1e-5);
        }
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(sum[c] / map[c], 1, 1e-5) << count;
            EXPECT_GT(std::abs(sum[c] / (map[c] / 2) - 1), 0.5);
        }
    }
    EXPECT_TRUE(clusterLights(test::environmentOf(test::constantMap(Rgb(0, 0, 0))), 8).empty());
}

TEST(Lights, BecomeTheMapAsTheyBecomeMany) {
    const World world(slabMesh(), test::constantMap(kSky));
    const ShadingPoint point = world.below();
    const Rgb truth = kSky * static_cast<float>(world.irradianceUnderSlab(point));
    TechniqueOptions many, few;
    many.lights.lights = 2000;
    few.lights.lights = 3;
    EXPECT_LT(relativeDifference(once(world, "lights", point, 0, many), truth), 0.02);
    EXPECT_GT(relativeDifference(once(world, "lights", point, 0, few), truth), 0.05);
}

// Texels just above the horizon of a slope shine. The rectangles that hold them have their middles
// below it, so that the printed form never finds them; the other does.
TEST(Pixel, OnlyThePrintedFormMissesTheHorizon) {
    constexpr std::size_t kRow = 14, kLit = 8;  // 6 to 11 degrees up, toward -Z
    Image map{64, 32, {}};
    map.pixels.assign(64 * 32, Rgb(0, 0, 0));
    for (std::size_t x = 0; x < kLit; ++x) map.pixels[kRow * 64 + x] = kSky;
    const float rise = std::tan(2 * static_cast<float>(kPi) / 180);
    TriangleMesh mesh;
    test::addQuad(mesh, {-2, 2 * rise, -2}, {-2, -2 * rise, 2}, {2, -2 * rise, 2},
                  {2, 2 * rise, -2});
    const World world(std::move(mesh), map);
    const ShadingPoint point = world.below();
    TechniqueOptions options;
    options.pixel.width = 24;
    options.pixel.height = 7;
    Rgb truth(0, 0, 0);
    for (int x = 0; x < static_cast<int>(kLit); ++x)
        truth += kSky * static_cast<float>(
                            test::texelMoment(64, 32, x, kRow).dot(Vec3d(point.place.normal)));
    const auto exact = makeEstimator("pixel", world.context(), options);
    const auto estimates = test::runEstimator(*exact, point, 64, 400);
    EXPECT_GT(test::agreementPValue(estimates, truth), test::significance(1));
    EXPECT_LT(test::agreementPValue(estimates, truth * 1.1f), test::significance(1));
    EXPECT_EQ(once(world, "pixel-printed", point, 64, options), Rgb(0, 0, 0));
}

struct Variant {
    std::string name, estimator;
    TechniqueOptions options;
    Sequence (*sequence)(std::uint32_t samples) = nullptr;  ///< null: the standard one
};

std::vector<Variant> variants() {
    std::vector<Variant> all;
    const auto add = [&](const std::string& name, const std::string& estimator,
                         const std::function<void(TechniqueOptions&)>& set,
                         Sequence (*sequence)(std::uint32_t) = nullptr) {
        Variant variant{name, estimator, {}, sequence};
        variant.options.paper.triangles = 320;
        set(variant.options);
        all.push_back(variant);
    };
    add("TableFree", "paper", [](TechniqueOptions& o) { o.paper.exactConvolution = true; });
    add("Defensive", "paper", [](TechniqueOptions& o) { o.paper.beta = 0.3; });
    add("Linear", "paper", [](TechniqueOptions& o) { o.paper.order = 1; });
    add("LinearDefensive", "paper-image",
        [](TechniqueOptions& o) { o.paper.order = 1, o.paper.beta = 0.3; });
    add("AllUniform", "paper", [](TechniqueOptions& o) { o.paper.beta = 1; });
    add("CoarseCache", "paper", [](TechniqueOptions& o) { o.paper.cacheLevel = 1; });
    add("CoarseImageCache", "paper-image", [](TechniqueOptions& o) { o.paper.cacheLevel = 1; });
    add("CoarsePixels", "pixel",
        [](TechniqueOptions& o) { o.pixel.width = 8, o.pixel.height = 4; });
    add(
        "LarcherXor", "cosine", [](TechniqueOptions&) {}, larcherXor);
    add(
        "LarcherShift", "cosine", [](TechniqueOptions&) {}, larcherShift);
    return all;
}

class Variants : public testing::TestWithParam<std::size_t> {};

INSTANTIATE_TEST_SUITE_P(Options, Variants, testing::Range<std::size_t>(0, variants().size()),
                         [](const auto& test) { return variants()[test.param].name; });

// With its control: 3 % more is rejected.
TEST_P(Variants, AreUnbiased) {
    const Variant variant = variants()[GetParam()];
    const World world(slabMesh(), test::constantMap(kSky));
    const ShadingPoint point = world.below();
    const Rgb truth = kSky * static_cast<float>(world.irradianceUnderSlab(point));
    const double level = test::significance(3);
    for (const int samples : {1, 5, 64}) {
        EstimatorContext context = world.context();
        if (variant.sequence)
            context.sequence = variant.sequence(static_cast<std::uint32_t>(samples));
        const auto estimator = makeEstimator(variant.estimator, context, variant.options);
        const auto estimates = test::runEstimator(*estimator, point, samples, 1000);
        EXPECT_GT(test::agreementPValue(estimates, truth), level) << samples;
        if (samples == 64) {
            EXPECT_LT(test::agreementPValue(estimates, truth * 1.03f), level);
        }
    }
}

// Under lamps. Control: 15 % more is rejected.
TEST(Techniques, OfTheStudyAreUnbiasedUnlessTheySaySo) {
    const Image map = test::noiseMap(16, 8, 3);
    const World world(slabMesh(), map);
    const ShadingPoint point = world.below();
    const Rgb truth = test::tracedIrradiance(world.scene, point, map, 64);
    TechniqueOptions options;
    options.paper.triangles = 320;
    const double level = test::significance(3);
    int compared = 0;
    for (const Technique& technique : techniques()) {
        if (technique.entry || technique.bias != "none") continue;
        const auto estimator = makeEstimator(technique.name, world.context(), options);
        const auto estimates = test::runEstimator(*estimator, point, 64, 600);
        EXPECT_GT(test::agreementPValue(estimates, truth), level) << technique.name;
        EXPECT_LT(test::agreementPValue(estimates, truth * 1.15f), level) << technique.name;
        ++compared;
    }
    EXPECT_EQ(compared, 3);
}

TEST(Techniques, AreRefusedByNameWhereThereIsNone) {
    test::expectError([] { findTechnique("pixels"); }, "--estimator pixels", "pixel-printed");
}

/// Variance of three thousand estimates of `name` at a place, one after another.
double varianceAt(const World& world, const std::string& name, int threshold) {
    TechniqueOptions options;
    options.paper.triangles = 320;
    options.paper.threshold = threshold;
    EstimatorContext context = world.context();
    context.cache = nullptr;
    return test::runEstimator(*makeEstimator(name, context, options), world.below(), 16, 3000)
        .sampleVariance(1);
}

// Where half of the light is hidden, the rays of earlier pixels take noise away. Control: a
// threshold that no count reaches leaves the noise of `paper` without a cache.
TEST(ImageCache, LearnsWhatIsHidden) {
    TriangleMesh mesh = floorMesh();
    test::addFloor(mesh, 0.6f, 0, 2, -2, 2);
    const World world(std::move(mesh), test::constantMap(kSky));
    const double without = varianceAt(world, "paper", 3);
    EXPECT_NEAR(varianceAt(world, "paper-image", 3) / without, 0.4, 0.06);
    EXPECT_NEAR(varianceAt(world, "paper-image", 1000000) / without, 1, 1e-6);
}

}  // namespace
}  // namespace shadowcache::study
