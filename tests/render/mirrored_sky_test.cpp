// What smooth surfaces mirror of the sky onto others: the same light as by brute force, with less
// noise, by light group as well.

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "render/estimators/light_groups.h"
#include "render/frame/integrator.h"
#include "render/table/estimator_table.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

/// A floor beside a wall of metal, under a sky with a bright spot that the wall mirrors.
class MirroredSky : public testing::Test {
protected:
    static constexpr int kSize = 12, kFilms = 40;

    /// The picture's mean green for seeds 1 .. kFilms, of light that bounced once.
    std::vector<double> films(float roughness, float albedo, bool shared) const {
        TriangleMesh mesh;
        test::addFloor(mesh, 0, -2, 2, -2, 2);
        test::addQuad(mesh, {-2, 0, -2}, {-2, 3, -2}, {-2, 3, 2}, {-2, 0, 2});
        Material plain, metal;
        plain.albedo = Rgb(0.7f);
        metal.albedo = Rgb(albedo);
        metal.finish.gloss = Gloss{.metallic = 1, .roughness = roughness};
        mesh.materials = {plain, metal};
        mesh.parts = {{0, 2, 0}, {2, 2, 1}};
        const Scene scene(mesh);
        Image map = test::gradientMap(64, 32, {0.3, 0.6, 0.4});
        for (int x = 0; x < 4; ++x)
            map.pixels[static_cast<std::size_t>(10 * map.width + 46 + x)] = Rgb(500.0f);
        const Environment environment = test::environmentOf(map, 0);
        const LightGroups groups({}, mesh, nullptr);
        EstimatorContext context{scene, environment, nullptr};
        context.groups = &groups;
        const auto estimator = findEstimator("mis").make(context, {});
        RenderOptions options;
        options.width = options.height = kSize;
        options.cameraRays = 4;
        options.samples = 1;
        options.bounces = 1;
        options.sharedBounces = shared;
        FrameRequest frame{*estimator, lookAt({0.5, 3, 0}, {0.5, 0, 0}, {0, 0, 1}, 0.7), 1,
                           options};
        std::vector<double> means;
        RenderStats stats;
        for (int seed = 1; seed <= kFilms; ++seed) {
            frame.options.seed = static_cast<std::uint64_t>(seed);
            const Film film = render(frame, stats);
            double sum = 0;
            for (std::size_t i = 0; i < film.pixels.size(); ++i) {
                EXPECT_NEAR(film.groupColors[i][LightGroups::kSky].y, film.pixels[i].color.y,
                            1e-4f * (1 + film.pixels[i].color.y));
                sum += static_cast<double>(film.pixels[i].diffuseIndirect.y);
            }
            means.push_back(sum / static_cast<double>(film.pixels.size()));
        }
        return means;
    }

    static double variance(const std::vector<double>& values) {
        double mean = 0, sum = 0;
        for (const double v : values) mean += v / static_cast<double>(values.size());
        for (const double v : values) sum += (v - mean) * (v - mean);
        return sum / static_cast<double>(values.size() - 1);
    }
};

// Control: a wall that mirrors a fifth less.
TEST_F(MirroredSky, IsThatOfBruteForce) {
    const std::vector<double> shared = films(0.2f, 0.9f, true), brute = films(0.2f, 0.9f, false);
    const double level = test::significance(1);
    EXPECT_GT(test::sameMeanPValue(shared, brute), level);
    EXPECT_LT(test::sameMeanPValue(shared, films(0.2f, 0.72f, true)), level) << "control";
}

// Control: a rough wall has what it mirrors for one place alone, as by brute force.
TEST_F(MirroredSky, HasLessNoiseThanBruteForce) {
    EXPECT_LT(variance(films(0.2f, 0.9f, true)), 0.4 * variance(films(0.2f, 0.9f, false)));
    EXPECT_GT(variance(films(0.9f, 0.9f, true)), 0.4 * variance(films(0.9f, 0.9f, false)))
        << "control";
}

}  // namespace
}  // namespace shadowcache
