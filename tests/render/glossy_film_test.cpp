// Pictures of glossy surfaces, for numbers of camera rays and samples, and their parts.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "common/mesh/placed_mesh.h"
#include "common/shot/camera_rays.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "tests/support/glossy_reference.h"
#include "tests/support/lit_floor.h"
#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

using test::Effort;

const test::GlossyLook kVarnish{Rgb(0.5f, 0.3f, 0.2f), {.roughness = 0.4f}};
const test::GlossyLook kBrass{Rgb(0.9f, 0.7f, 0.3f), {.metallic = 1, .roughness = 0.2f}};

/// A floor, and by what it is rendered.
struct GlossyCase {
    std::string name;
    test::GlossyLook look;
    bool all;  ///< by `mis`, and with every lie in the cache; else with one lie
};

/// The floor under a slab, seen from the side: a few pixels of it.
class GlossyFloor : public testing::TestWithParam<GlossyCase> {
protected:
    static constexpr int kSide = 3;

    RenderOptions optionsOf(const Effort& chosen) const {
        RenderOptions options;
        options.width = options.height = kSide;
        options.filter = FilterKind::box;
        options.cameraRays = chosen.cameraRays;
        options.samples = chosen.samples;
        options.plain = {GetParam().look.baseColor, GetParam().look.gloss};
        return options;
    }

    /// Mean colour of the film, by brute force at some places of each pixel.
    Rgb truth(int nodes) const {
        const CameraRays rays(camera_, 1);
        const int side = kSide * nodes;
        Rgb sum(0.0f);
        for (int k = 0; k < side * side; ++k) {
            const int column = k % side, row = k / side;
            const FilmPosition at{(column + 0.5) / side, (row + 0.5) / side};
            const auto [start, direction, cosine, skipped, reach] = rays.through(at);
            const Vec3d from = start - world_.mesh.origin;
            const ShadingPoint point =
                test::pointAlong(world_.scene, Vec3f(from), Vec3f(direction));
            sum += test::tracedReflection(world_.scene, point, GetParam().look, -direction,
                                          world_.environment);
        }
        return sum / static_cast<float>(side * side);
    }

    /// Mean colours of films with the seeds 1 .. count.
    test::Estimates films(const std::string& name, const test::TestCache& cache,
                          const Effort& chosen, int count) const {
        EstimatorContext context = world_.context();
        context.cache = &cache.cache();
        const auto estimator = findEstimator(name).make(context, {});
        FrameRequest frame{*estimator, camera_, 1, optionsOf(chosen)};
        RenderOptions& options = frame.options;
        RenderStats stats;
        options.seed = 1000;
        frame.plan = planFrame(frame, stats);
        test::Estimates found;
        for (options.seed = 1; found.color[0].size() < static_cast<std::size_t>(count);
             ++options.seed) {
            std::array<double, 3> sum{};
            for (const Pixel& pixel : render(frame, stats).pixels)
                for (std::size_t c = 0; c < 3; ++c)
                    sum[c] += static_cast<double>(pixel.color[static_cast<int>(c)]);
            for (std::size_t c = 0; c < 3; ++c) found.color[c].push_back(sum[c] / (kSide * kSide));
        }
        return found;
    }

    const test::World world_{test::slabMesh(), test::noiseMap(64, 32, 7)};
    const Camera camera_ = lookAt({0.4, 0.3, -0.9}, {0, 0, 0}, {0, 1, 0}, 0.3);
};

// For K camera rays and N samples, by `mis` and by `cache` with every lie in the cache. With its
// control: 3 % more is rejected where there are enough samples.
TEST_P(GlossyFloor, IsBruteForcesForAllEfforts) {
    constexpr std::array kEfforts{Effort{1, 1}, Effort{4, 1}, Effort{2, 3}, Effort{8, 8}};
    const Rgb wanted = truth(2);
    const bool all = GetParam().all;
    const auto kinds = all ? test::cacheKinds() : std::vector{test::cacheKinds()[1]};
    const double level = test::significance(kEfforts.size() * (kinds.size() + 1));
    const auto check = [&](const std::string& name, const test::TestCache& cache,
                           const std::string& kind) {
        for (const Effort& chosen : kEfforts) {
            SCOPED_TRACE(
                fmt::format("{} {} {} x {}", name, kind, chosen.cameraRays, chosen.samples));
            const bool many = chosen.samples == 8;
            const test::Estimates found = films(name, cache, chosen, many ? 300 : 400);
            // The camera's pixel has nodes of its own: the truth is that good.
            EXPECT_GT(test::agreementPValue(found, wanted), level)
                << found.mean(0) << " for " << wanted.x;
            if (many) {
                EXPECT_LT(test::agreementPValue(found, wanted * 1.03f), level);
            }
        }
    };
    if (all) check("mis", world_.cache, "");
    for (const test::CacheKind& kind : kinds) {
        BakeResult told = world_.baked;
        kind.change(told);
        check("cache", test::TestCache(told), kind.name);
    }
}

INSTANTIATE_TEST_SUITE_P(Looks, GlossyFloor,
                         testing::Values(GlossyCase{"Varnish", kVarnish, true},
                                         GlossyCase{"Brass", kBrass, true},
                                         GlossyCase{"BrassWithOneLie", kBrass, false}),
                         [](const auto& test) { return test.param.name; });

/// A square that is lit, glossy and a lamp, before the sky.
class Parts : public testing::Test {
protected:
    Parts() {
        test::addFloor(mesh_, 0, -1, 1, -1, 1);
        mesh_.parts = {{0, 2, 0}};
        Material& material = mesh_.materials.emplace_back();
        material.albedo = Rgb(0.5f, 0.25f, 0.75f);
        material.finish.gloss = Gloss{.metallic = 0.3f, .roughness = 0.4f};
        material.finish.emission = Rgb(0.5f, 0, 0.125f);
    }

    Film render(const RenderOptions& options) {
        const Scene scene(mesh_);
        const auto estimator = findEstimator("mis").make({scene, environment_, nullptr});
        RenderStats stats;
        return shadowcache::render(
            {*estimator, lookAt({0, 1, 2}, {0, 0, 0}, {0, 1, 0}, 0.9), 1, options}, stats);
    }

    static RenderOptions options() {
        RenderOptions options;
        options.width = 32;
        options.height = 24;
        options.samples = 4;
        options.cameraRays = 4;
        return options;
    }

    TriangleMesh mesh_;
    const Environment environment_ = test::environmentOf(test::noiseMap(64, 32, 7));
};

TEST_F(Parts, AddUpToThePicture) {
    int glossy = 0, sky = 0, edges = 0;
    for (const Pixel& p : render(options()).pixels) {
        const Rgb sum = p.diffuse + p.glossy + p.emission;
        for (int c = 0; c < 3; ++c) {
            const float size = std::abs(p.diffuse[c]) + std::abs(p.glossy[c]) + p.emission[c];
            EXPECT_NEAR(sum[c], p.color[c], 1e-6f * size);
        }
        glossy += p.glossy != Rgb(0.0f) ? 1 : 0;
        sky += p.coverage == 0 ? 1 : 0;
        // What is emitted, and the sky behind, each have their share of the camera rays.
        EXPECT_NEAR((p.emission - p.environment).z, 0.125f * p.coverage, 1e-5f * sum.z);
        if (p.coverage == 0) {
            EXPECT_EQ(p.environment, p.color);
        }
        edges += p.coverage > 0 && p.coverage < 1 ? 1 : 0;
        if (p.coverage < 1) continue;
        EXPECT_EQ(p.environment, Rgb(0.0f));
        EXPECT_FLOAT_EQ(p.emission.z, 0.125f);
        EXPECT_FLOAT_EQ(p.roughness, 0.4f);
        EXPECT_FLOAT_EQ(p.albedo.y, 0.25f);
    }
    EXPECT_GT(glossy, 100);
    EXPECT_GT(sky, 100);
    EXPECT_GT(edges, 5);
}

// A metal has no diffuse part, and none of its rays.
TEST_F(Parts, OfAMetalAreGlossyAlone) {
    mesh_.materials[0].finish.gloss->metallic = 1;
    mesh_.materials[0].finish.emission = Rgb(0.0f);
    for (const Pixel& p : render(options()).pixels) {
        if (p.coverage < 1) continue;
        EXPECT_EQ(p.diffuse, Rgb(0.0f));
        EXPECT_EQ(p.color, p.glossy);
        EXPECT_LE(p.rays, 16);
    }
}

TEST_F(Parts, UnlitTakesNoRays) {
    mesh_.materials[0].finish.unlit = true;
    for (const Pixel& p : render(options()).pixels) {
        if (p.coverage < 1) continue;
        EXPECT_FLOAT_EQ(p.color.x, 0.5f);
        EXPECT_EQ(p.color, p.emission);
        EXPECT_EQ(p.rays, 0);
    }
}

// The spread of the picture over seeds is what the pixels tell, with one camera ray and with four.
TEST_F(Parts, TellTheVarianceOfTheColor) {
    for (const int rays : {1, 4}) {
        RenderOptions chosen = options();
        chosen.cameraRays = rays;
        chosen.samples = 16;
        chosen.crop = FilmRectangle{12, 12, 8, 6};
        constexpr int kFilms = 100;
        std::vector<double> sum(48), squares(48);
        double told = 0;
        for (chosen.seed = 1; chosen.seed <= kFilms; ++chosen.seed) {
            const Film film = render(chosen);
            for (std::size_t i = 0; i < sum.size(); ++i) {
                const auto x = static_cast<double>(environment_.luminance(film.pixels[i].color));
                sum[i] += x;
                squares[i] += x * x;
                told += static_cast<double>(film.pixels[i].colorVariance) / kFilms;
            }
        }
        double spread = 0;
        for (std::size_t i = 0; i < sum.size(); ++i)
            spread += (squares[i] - sum[i] * sum[i] / kFilms) / (kFilms - 1);
        // Samples are stratified, which their differences do not see in full.
        EXPECT_GT(told / spread, 0.8) << rays;
        EXPECT_LT(told / spread, 2.0) << rays;
    }
}

}  // namespace
}  // namespace shadowcache
