// Sets, caches and options at the ends of their ranges.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "common/import/load_mesh.h"
#include "common/random/sequence.h"
#include "render/frame/integrator.h"
#include "render/table/estimator_table.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

const Rgb kSky(1, 0.5f, 2);
/// The mesh scaled, then moved, as a file of it would be loaded.
TriangleMesh throughAFile(TriangleMesh mesh, double scale, const Vec3d& shift, bool farTriangle) {
    if (farTriangle) {
        const Vec3f far(Vec3d(-2) * shift / scale);
        test::addTriangle(mesh, far, far + Vec3f(1, 0, 0), far + Vec3f(0, 0, 1));
    }
    std::ostringstream text;
    text.precision(17);
    for (const Vec3f& p : mesh.positions) {
        const Vec3d q = Vec3d(p) * scale + shift;
        text << "v " << q.x << ' ' << q.y << ' ' << q.z << '\n';
    }
    for (const Vec3i& t : mesh.triangles)
        text << "f " << t.x + 1 << ' ' << t.y + 1 << ' ' << t.z + 1 << '\n';
    const test::TemporaryFolder folder;
    const std::filesystem::path path = folder.write("set.obj", text.str());
    return loadMesh({&path, 1}, {});
}

/// A place in a set that is baked, under a sky of radiance kSky.
struct LitPlace : test::World {
    ShadingPoint point;

    LitPlace(TriangleMesh set, const BakeOptions& options, const Vec3f& from, const Vec3f& along)
        : World(std::move(set), test::constantMap(kSky), options),
          point(test::pointAlong(scene, from, along)) {}

    Rgb truthUnderTheSlab() const { return kSky * static_cast<float>(irradianceUnderSlab(point)); }
};

EstimatorOptions fewTriangles() {
    EstimatorOptions options;
    options.paper.triangles = 320;
    return options;
}

LitPlace slabWorld(double spacing, int level = kMaxCacheLevel) {
    BakeOptions options;
    options.spacing = spacing;
    options.level = level;
    return {test::slabMesh(), options, {0, 0.25f, 0}, {0, -1, 0}};
}

/// With its control: at 64 samples the same estimates must not agree with 5 % more. `repeats` is
/// how often the test does this.
void expectTruth(const std::vector<test::NamedEstimator>& estimators, const ShadingPoint& point,
                 const Rgb& truth, std::size_t repeats = 1) {
    const double level = test::significance(2 * repeats * estimators.size());
    for (const auto& [name, estimator] : estimators)
        for (const auto& [samples, count] : {std::pair(1, 2000), std::pair(64, 400)}) {
            const auto estimates = test::runEstimator(*estimator, point, samples, count);
            EXPECT_GT(test::agreementPValue(estimates, truth), level)
                << name << ", " << samples << " samples: mean " << estimates.mean(1)
                << ", standard error " << std::sqrt(estimates.sampleVariance(1) / count)
                << ", expected " << truth.y;
            if (samples == 64) {
                EXPECT_LT(test::agreementPValue(estimates, truth * 1.05f), level) << name;
            }
        }
}

std::vector<test::NamedEstimator> cached(const EstimatorContext& context) {
    std::vector<test::NamedEstimator> both;
    for (const char* name : {"paper", "cache"})
        both.push_back({name, findEstimator(name).make(context, fewTriangles())});
    return both;
}

/// What the cache alone says, without a ray.
double predicted(const EstimatorContext& context, const ShadingPoint& point) {
    const auto estimator = findEstimator("cache").make(context);
    return test::runEstimator(*estimator, point, 0, 1).mean(0);
}

struct Place {
    std::string name;
    double scale;
    Vec3d shift;
    bool farTriangle;  ///< at the other end of the world: no choice of origin brings both near
};

class Coordinates : public testing::TestWithParam<Place> {};

INSTANTIATE_TEST_SUITE_P(Extreme, Coordinates,
                         testing::Values(Place{"OfAMillionth", 1e-6, {0, 0, 0}, false},
                                         Place{"OfAMillion", 1e6, {0, 0, 0}, false},
                                         Place{"AMillionAway", 1, {1e6, -1e6, 1e6}, false},
                                         Place{"AtBothEnds", 1000, {1e6, 0, 1e6}, true}),
                         [](const auto& test) { return test.param.name; });

TEST_P(Coordinates, ChangeNoEstimate) {
    const Place& place = GetParam();
    TriangleMesh mesh = throughAFile(test::slabMesh(), place.scale, place.shift, place.farTriangle);
    ASSERT_EQ(mesh.triangles.size(),
              test::slabMesh().triangles.size() + (place.farTriangle ? 1 : 0));
    BakeOptions options;
    options.spacing = 0.5 * place.scale;
    const Vec3f from(Vec3d(0, 0.25, 0) * place.scale + place.shift - mesh.origin);
    const LitPlace world(std::move(mesh), options, from, {0, -1, 0});
    const Rgb truth = world.truthUnderTheSlab();
    expectTruth(test::everyEstimator(world.context(), fewTriangles()), world.point, truth);
    const auto exact = static_cast<double>(truth.x);
    EXPECT_NEAR(predicted(world.context(), world.point) / exact, 1, 0.05);
}

TEST(OneTriangle, IsLitOnBothSides) {
    TriangleMesh mesh;
    test::addTriangle(mesh, {0, 0, 0}, {0, 0, 1}, {1, 0, 0});
    BakeOptions options;  // no spacing given: the bake finds one
    options.level = 2;
    options.rays = 1;
    const LitPlace world(mesh, options, {0.2f, 1, 0.3f}, {0, -1, 0});
    EXPECT_GT(world.baked.items.size(), 0u);
    const auto estimators = test::everyEstimator(world.context(), fewTriangles());
    for (const ShadingPoint& point :
         {world.point, test::pointAlong(world.scene, {0.2f, -1, 0.3f}, {0, 1, 0})}) {
        for (const auto& [name, estimator] : estimators) {
            const auto estimates = test::runEstimator(*estimator, point, 256, 100);
            EXPECT_NEAR(estimates.mean(2) / (2 * kPi), 1, 0.01) << name;
        }
        EXPECT_NEAR(predicted(world.context(), point) / kPi, 1, 5e-3);
    }
}

TEST(Spacing, OfAThousandthOfTheSetIsBaked) {
    // A strip, so that a thousand voxels along one side are few in all.
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -0.5f, 0.5f, -0.005f, 0.005f);
    test::addBox(mesh, {0.005f, 0.01f, -0.005f}, {0.5f, 0.015f, 0.005f});
    BakeOptions options;
    options.spacing = 1e-3;
    options.level = 3;
    options.rays = 4;
    const LitPlace world(std::move(mesh), options, {0, 0.005f, 0}, {0, -1, 0});
    EXPECT_GT(world.baked.items.size(), 25000u);
    const Rgb truth = world.truthUnderTheSlab();
    expectTruth(cached(world.context()), world.point, truth);
    EXPECT_NEAR(predicted(world.context(), world.point) / static_cast<double>(truth.x), 1, 0.03);
}

TEST(Spacing, UpToTwiceTheSetChangesNoMean) {
    constexpr double kExtent = 10;
    for (const double share : {0.05, 0.3, 1.0, 2.0}) {
        SCOPED_TRACE(share);
        const LitPlace world = slabWorld(share * kExtent);
        expectTruth(cached(world.context()), world.point, world.truthUnderTheSlab(), 4);
    }
}

TEST(Spacing, BelowWhatVoxelsCanCountIsRefused) {
    const TriangleMesh mesh = test::slabMesh();
    const Scene scene(mesh);
    BakeOptions options;
    options.spacing = 1e-7;
    test::expectError([&] { bake(scene, options); }, "spacing 1e-07", "expected at least 9.5");
}

TEST(Samples, SixtyFiveThousandOfAPixelComeToTheTruth) {
    const LitPlace world = slabWorld(0.5);
    const Camera camera =
        lookAt(Vec3d(0.01, 0.25, 0), world.point.place.position, Vec3d(0, 0, 1), 0.1);
    RenderOptions options;
    options.width = options.height = 1;
    options.samples = 65536;
    const double truth = static_cast<double>(world.truthUnderTheSlab().y);
    for (const auto& [name, estimator] : test::everyEstimator(world.context(), fewTriangles())) {
        RenderStats stats;
        const Film film = render({*estimator, camera, 1, options}, stats);
        const Pixel& pixel = film.pixels[0];
        EXPECT_NEAR(static_cast<double>(pixel.irradiance.y) / truth, 1, 2e-3) << name;
        EXPECT_LE(pixel.rays, 65536.0f) << name;
        EXPECT_LT(std::sqrt(static_cast<double>(pixel.variance)), 0.01 * truth) << name;
        // Control: one sample does not come that near.
        options.samples = 1;
        double worst = 0;
        for (options.seed = 1; options.seed <= 50; ++options.seed) {
            const Film rough = render({*estimator, camera, 1, options}, stats);
            worst = std::max(worst,
                             std::abs(static_cast<double>(rough.pixels[0].irradiance.y) - truth));
        }
        EXPECT_GT(worst, 4e-3 * truth) << name;
        options.samples = 65536;
    }
}

TEST(Alpha, UpToAlmostOneChangesNoMean) {
    const LitPlace world = slabWorld(0.5);
    const Rgb truth = world.truthUnderTheSlab();
    for (const double alpha : {0.0, 0.5, 1 - 1e-6}) {
        SCOPED_TRACE(alpha);
        EstimatorOptions options = fewTriangles();
        options.paper.alpha = alpha;
        EXPECT_NO_THROW(validate(options.paper));
        std::vector<test::NamedEstimator> paper;
        paper.push_back({"paper", findEstimator("paper").make(world.context(), options)});
        expectTruth(paper, world.point, truth, 3);
    }
}

TEST(Alpha, OfOneIsRefused) {
    PaperOptions options;
    for (const double alpha : {1.0, 1.5, -1e-9, std::nan("")}) {
        options.alpha = alpha;
        test::expectError([&] { validate(options); }, "--alpha", "below 1");
    }
}

TEST(Counts, At255AreReadAsCounted) {
    BakeOptions options;
    options.spacing = 0.5;
    options.level = 3;
    options.rays = 255;
    options.adaptive = false;
    const LitPlace world(test::slabMesh(), options, {0, 0.25f, 0}, {0, -1, 0});
    const CacheItems& items = world.baked.items;
    EXPECT_EQ(*std::max_element(items.d.begin(), items.d.end()), 255);
    EXPECT_EQ(*std::max_element(items.n.begin(), items.n.end()), 255);
    const Rgb truth = world.truthUnderTheSlab();
    const auto exact = static_cast<double>(truth.x);
    EXPECT_NEAR(predicted(world.context(), world.point) / exact, 1, 0.01);
    expectTruth(cached(world.context()), world.point, truth);

    // Control: what a reader of signed bytes would make of them, up to 127, is seen.
    BakeResult halved = world.baked;
    for (std::uint8_t& n : halved.items.n) n = std::min<std::uint8_t>(n, 127);
    for (CountBlock& block : halved.items.blocks)
        for (std::uint8_t& n : block.n) n = std::min<std::uint8_t>(n, 127);
    const test::TestCache wrong(halved);
    EstimatorContext context = world.context();
    context.cache = &wrong.cache();
    EXPECT_LT(predicted(context, world.point), 0.9 * exact);
}

}  // namespace
}  // namespace shadowcache
