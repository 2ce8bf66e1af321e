// The path that the programs take by default, against known truths: a pilot pass, samples shared
// out by its budget, several camera rays a pixel, neighbours that share mispredicted samples.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "tests/support/lit_floor.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

using test::CacheKind;
using test::cacheKinds;
using test::Effort;
using test::effort;
using test::Light;
using test::LitFloor;
using test::View;

constexpr int kWidth = View::kWidth, kHeight = View::kHeight, kStrips = LitFloor::kStrips;

/// Films of seeds of their own after one pilot.
std::vector<Film> films(Estimator& estimator, RenderOptions options, int count) {
    RenderStats stats;
    options.seed = 1000;
    FrameRequest frame{estimator, View::camera(), 1, options};
    frame.plan = planFrame(frame, stats);
    std::vector<Film> all;
    for (frame.options.seed = 1; static_cast<int>(all.size()) < count; ++frame.options.seed)
        all.push_back(render(frame, stats));
    return all;
}

/// The mean irradiance of a strip in each film.
test::Estimates stripMeans(const std::vector<Film>& films, int strip) {
    constexpr int kPixels = kHeight * (kWidth / kStrips);
    test::Estimates means;
    for (const Film& film : films) {
        Vec3d sum(0.0);
        for (int y = 0; y < kHeight; ++y)
            for (int x = strip * kWidth / kStrips; x < (strip + 1) * kWidth / kStrips; ++x)
                sum += Vec3d(film.pixels[static_cast<std::size_t>(y * kWidth + x)].irradiance);
        sum /= kPixels;
        for (int c = 0; c < 3; ++c) means.color[static_cast<std::size_t>(c)].push_back(sum[c]);
    }
    return means;
}

constexpr Effort kEfforts[] = {{1, 1}, {1, 4},  {1, 16}, {1, 64}, {4, 1},
                               {4, 4}, {4, 16}, {16, 1}, {16, 4}, {16, 16}};

TEST(DefaultPathScene, IsWhatItsTruthTakesItFor) {
    const LitFloor floor(cacheKinds().front());
    for (const double x : {0.0, 0.5, 1.0})
        for (const double y : {0.0, 1.0}) {
            ShadingPoint point = View::place(x, y);
            point.place.rayOrigin.y = 1e-5f;
            const auto lit = [&](const std::array<int, 2>& texel) {
                return test::tracedTexelIrradiance(floor.scene, point, Light::kMapWidth,
                                                   Light::kMapHeight, texel[0], texel[1], 40);
            };
            const auto& [column, row] = floor.light.seen;
            EXPECT_NEAR(lit(floor.light.seen) /
                            test::texelMoment(Light::kMapWidth, Light::kMapHeight, column, row).y,
                        1, 1e-3);
            EXPECT_EQ(lit(floor.light.hidden), 0.0);
        }
    // The film shows the floor that View::place() says.
    const auto estimator = findEstimator("mis").make(floor.context());
    RenderStats stats;
    const Film film = render({*estimator, View::camera(), 1, effort(1, 1)}, stats);
    for (int y = 0; y < kHeight; y += kHeight - 1)
        for (int x = 0; x < kWidth; x += kWidth - 1) {
            const Pixel& pixel = film.pixels[static_cast<std::size_t>(y * kWidth + x)];
            const Vec3d wanted =
                View::place((x + 0.5) / kWidth, (y + 0.5) / kHeight).place.position;
            EXPECT_LT((Vec3d(pixel.position) - wanted).length(), 1e-5);
        }
}

struct Path {
    std::string name, estimator;
    CacheKind cache;
    int films;  ///< averaged over at 1 x 1
};

std::vector<Path> paths() {
    std::vector<Path> all{{"Mis", "mis", cacheKinds().front(), 1600}};
    for (const CacheKind& kind : cacheKinds()) all.push_back({kind.name, "cache", kind, 600});
    return all;
}

class DefaultPath : public testing::TestWithParam<std::size_t> {};

INSTANTIATE_TEST_SUITE_P(Caches, DefaultPath, testing::Range<std::size_t>(0, paths().size()),
                         [](const auto& test) { return paths()[test.param].name; });

// With its control: 4 % more is rejected.
TEST_P(DefaultPath, MeetsTheClosedForm) {
    const Path path = paths()[GetParam()];
    const LitFloor floor(path.cache);
    const auto estimator = findEstimator(path.estimator).make(floor.context());
    const double level = test::significance(kStrips * std::size(kEfforts));
    for (const auto& [cameraRays, samples] : kEfforts) {
        SCOPED_TRACE(fmt::format("{} x {}", cameraRays, samples));
        const int count = std::max(24, path.films / (cameraRays * samples));
        const std::vector<Film> all = films(*estimator, effort(cameraRays, samples), count);
        for (int strip = 0; strip < kStrips; ++strip) {
            const test::Estimates means = stripMeans(all, strip);
            const Rgb truth = floor.truth(strip, cameraRays == 1 ? 1 : 3);
            const double error = std::sqrt(means.sampleVariance(1) / count);
            EXPECT_GT(test::agreementPValue(means, truth), level)
                << "strip " << strip << ": mean " << means.mean(1) << ", standard error " << error
                << ", wanted " << truth.y;
            EXPECT_LT(test::agreementPValue(means, truth * 1.04f), level)
                << "strip " << strip << ", standard error " << error;
        }
    }
}

/// Variance of a pixel's irradiance over films, averaged over the pixels.
double pixelVariance(const std::vector<Film>& films) {
    double sum = 0;
    for (std::size_t p = 0; p < films.front().pixels.size(); ++p) {
        double mean = 0, squares = 0;
        for (const Film& film : films) mean += static_cast<double>(film.pixels[p].irradiance.y);
        mean /= static_cast<double>(films.size());
        for (const Film& film : films)
            squares += std::pow(static_cast<double>(film.pixels[p].irradiance.y) - mean, 2);
        sum += squares / static_cast<double>(films.size() - 1);
    }
    return sum / static_cast<double>(films.front().pixels.size());
}

/// How much of the variance may be left by four times the camera rays, and by sixteen times the
/// samples.
struct Falls {
    double withCameraRays, withSamples;
};

/// All but the slowest two.
class DefaultPathNoise : public DefaultPath {};

INSTANTIATE_TEST_SUITE_P(Caches, DefaultPathNoise, testing::Values<std::size_t>(0, 1, 2, 5, 6),
                         [](const auto& test) { return paths()[test.param].name; });

// Control: the same light samples for all camera rays of a pixel would leave all of the variance,
// as a pixel of one camera ray has it.
TEST_P(DefaultPathNoise, FallsWithCameraRaysAndWithSamples) {
    const Path path = paths()[GetParam()];
    const LitFloor floor(path.cache);
    const auto estimator = findEstimator(path.estimator).make(floor.context());
    const Falls most = path.estimator == "mis" ? Falls{0.3, 0.1} : Falls{0.35, 0.2};
    constexpr int kSteps = 3;  // 1, 4, 16
    double variance[kSteps][kSteps];
    for (int k = 0; k < kSteps; ++k)
        for (int n = 0; n < kSteps; ++n)
            variance[k][n] = pixelVariance(films(*estimator, effort(1 << 2 * k, 1 << 2 * n),
                                                 path.films / (path.estimator == "mis" ? 32 : 20)));
    for (int k = 0; k < kSteps; ++k) {
        SCOPED_TRACE(fmt::format("{} camera rays", 1 << 2 * k));
        EXPECT_LT(variance[k][kSteps - 1], most.withSamples * variance[k][0]);
        for (int n = 0; n < kSteps && k > 0; ++n)
            EXPECT_LT(variance[k][n], most.withCameraRays * variance[k - 1][n])
                << (1 << 2 * n) << " samples";
    }
}

// Samples are shared out between the pixels; their mean stays what was asked for. A direction below
// the horizon takes no ray. Control: twice the samples are out of the range.
TEST_P(DefaultPath, TracesTheRaysAskedFor) {
    const Path path = paths()[GetParam()];
    const LitFloor floor(path.cache);
    const auto estimator = findEstimator(path.estimator).make(floor.context());
    const auto raysOf = [&](int cameraRays, int samples) {
        double rays = 0;
        const std::vector<Film> all = films(*estimator, effort(cameraRays, samples), 4);
        for (const Film& film : all)
            for (const Pixel& pixel : film.pixels)
                rays += static_cast<double>(pixel.rays - pixel.reusedRays);
        return rays / (kWidth * kHeight * static_cast<double>(all.size()));
    };
    for (const auto& [cameraRays, samples] : {Effort{1, 4}, {16, 1}, {4, 4}, {1, 64}}) {
        SCOPED_TRACE(fmt::format("{} x {}", cameraRays, samples));
        const double wanted = cameraRays * samples, rays = raysOf(cameraRays, samples);
        EXPECT_GT(rays, 0.7 * wanted);
        EXPECT_LT(rays, 1.15 * wanted);
        EXPECT_GT(raysOf(cameraRays, 2 * samples), 1.15 * wanted);
    }
}

// The channel `variance` against the variance of repeated films. It comes from the spread of camera
// rays, which does not include how they share the strata of a cluster: up to twice too high.
TEST(DefaultPathFilm, EstimatesItsVariance) {
    const LitFloor floor(cacheKinds().front());
    const auto estimator = findEstimator("cache").make(floor.context());
    const std::vector<Film> all = films(*estimator, effort(16, 4), 60);
    double estimated = 0;
    for (const Film& film : all)
        for (const Pixel& pixel : film.pixels) estimated += static_cast<double>(pixel.variance);
    estimated /= kWidth * kHeight * static_cast<double>(all.size());
    const double measured = pixelVariance(all);
    EXPECT_GT(estimated, measured);
    EXPECT_LT(estimated, 2.6 * measured);
    EXPECT_GT(2 * estimated, 2.6 * measured) << "control";
    EXPECT_LT(estimated / 3, measured) << "control";
}

// Without samples the film is what the cache predicts, which a small picture with rays corrects.
// Control: what a cache predicts that is wrong everywhere.
TEST(DefaultPathFilm, WithoutSamplesIsNearTheTruth) {
    const auto worst = [](const CacheKind& kind, bool corrected) {
        const LitFloor floor(kind);
        const auto estimator = findEstimator("cache").make(floor.context());
        FrameRequest frame{*estimator, View::camera(), 1, effort(1, 0)};
        RenderStats stats;
        if (corrected) frame.plan = planFrame(frame, stats);
        const std::vector<Film> film{render(frame, stats)};
        double most = 0;
        for (int strip = 0; strip < kStrips; ++strip) {
            const double truth = static_cast<double>(floor.truth(strip, 1).y);
            most = std::max(most, std::abs(stripMeans(film, strip).mean(1) / truth - 1));
        }
        return most;
    };
    EXPECT_LT(worst(cacheKinds()[0], false), 0.01);
    EXPECT_GT(worst(cacheKinds()[1], false), 0.5);
    EXPECT_LT(worst(cacheKinds()[0], true), 0.05);
    EXPECT_LT(worst(cacheKinds()[1], true), 0.05);
}

// Frames have noise of their own: their errors are not those of the frame before.
TEST(DefaultPathFilm, FramesAreIndependent) {
    const LitFloor floor(cacheKinds().front());
    const auto estimator = findEstimator("cache").make(floor.context());
    RenderStats stats;
    std::vector<Film> frames;
    for (int number = 1; number <= 24; ++number)
        frames.push_back(render({*estimator, View::camera(), number, effort(1, 4)}, stats));
    const auto value = [&](std::size_t frame, std::size_t pixel) {
        return static_cast<double>(frames[frame].pixels[pixel].irradiance.y);
    };
    double same = 0, next = 0;
    for (std::size_t p = 0; p < frames[0].pixels.size(); ++p) {
        double mean = 0;
        for (std::size_t f = 0; f < frames.size(); ++f)
            mean += value(f, p) / static_cast<double>(frames.size());
        for (std::size_t f = 0; f + 1 < frames.size(); ++f) {
            same += std::pow(value(f, p) - mean, 2);
            next += (value(f, p) - mean) * (value(f + 1, p) - mean);
        }
    }
    EXPECT_GT(same, 0.0);
    EXPECT_LT(std::abs(next), 0.2 * same);
}

/// Fractions of a sample are rounded so that each pixel gets its share: the error of its mean over
/// films is what chance leaves. With its control: 5 % more.
TEST(DefaultPathFilm, NoPixelIsOff) {
    const LitFloor floor(cacheKinds()[3]);
    const auto estimator = findEstimator("cache").make(floor.context());
    const std::vector<Film> all = films(*estimator, effort(1, 1), 400);
    const auto count = static_cast<double>(all.size());
    double error = 0, more = 0;
    for (int p = 0; p < kWidth * kHeight; ++p) {
        const auto value = [&](const Film& film) {
            return static_cast<double>(film.pixels[static_cast<std::size_t>(p)].irradiance.y);
        };
        double mean = 0, squares = 0;
        for (const Film& film : all) mean += value(film) / count;
        for (const Film& film : all) squares += std::pow(value(film) - mean, 2);
        const double chance = squares / (count - 1) / count;
        const auto truth = static_cast<double>(floor.pixelTruth(p % kWidth, p / kWidth).y);
        error += std::pow(mean - truth, 2) / chance / (kWidth * kHeight);
        more += std::pow(mean - 1.05 * truth, 2) / chance / (kWidth * kHeight);
    }
    EXPECT_LT(error, 1.6);
    EXPECT_GT(more, 1.6);
}

/// Where all of the sky is seen, and the counts say so, samples find nothing to add: all pixels are
/// equal. Control: counts that are wrong.
TEST(DefaultPathFilm, LeavesNoNoiseInFullLight) {
    Image map = test::noiseMap(64, 32, 5);  // dark around the horizon, where cosines are not exact
    std::fill(map.pixels.begin() + 64 * 8, map.pixels.end(), Rgb(0, 0, 0));
    const test::World world(test::floorMesh(), map);
    const auto unevenness = [&](const CacheKind& kind, bool withPilot) {
        BakeResult baked = world.baked;
        kind.change(baked);
        const test::TestCache cache(baked);
        EstimatorContext context = world.context();
        context.cache = &cache.cache();
        const auto estimator = findEstimator("cache").make(context);
        RenderStats stats;
        FrameRequest frame{*estimator, View::camera(), 1, effort(4, 4)};
        if (withPilot) frame.plan = planFrame(frame, stats);
        const Film film = render(frame, stats);
        const auto [least, most] = std::ranges::minmax_element(
            film.pixels, {}, [](const Pixel& pixel) { return pixel.irradiance.y; });
        return static_cast<double>(most->irradiance.y / least->irradiance.y) - 1;
    };
    for (const bool withPilot : {false, true})
        EXPECT_LT(unevenness(cacheKinds().front(), withPilot), 1e-5) << withPilot;
    EXPECT_GT(unevenness(cacheKinds()[1], false), 1e-3);
}

/// What the pilot finds lowers the noise of a pixel, alone without neighbours, where counts are
/// wrong. Control: where they are right but for the noise of their rays, it finds less.
TEST(DefaultPathPixel, ThePilotLowersTheNoiseOfWrongCounts) {
    const auto left = [](const CacheKind& kind) {
        const LitFloor floor(kind);
        const auto variance = [&](bool withPilot) {
            const auto estimator = findEstimator("cache").make(floor.context());
            FrameRequest frame{*estimator, View::camera(), 1, effort(1, 16)};
            RenderOptions& options = frame.options;
            options.seed = 1000;
            RenderStats stats;
            if (withPilot) frame.plan = planFrame(frame, stats);
            options.width = options.height = 1;
            std::vector<Film> pixels;
            for (options.seed = 1; options.seed <= 400; ++options.seed)
                pixels.push_back(render(frame, stats));
            return pixelVariance(pixels);
        };
        return variance(true) / variance(false);
    };
    EXPECT_LT(left(cacheKinds()[2]), 0.5);
    EXPECT_LT(left(cacheKinds()[4]), 0.5);
    EXPECT_GT(left(cacheKinds()[0]), 0.55);
}

}  // namespace
}  // namespace shadowcache
