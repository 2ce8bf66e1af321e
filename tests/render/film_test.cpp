// Where camera rays go, what a crop shows, and what a pixel says of its variance.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <vector>

#include "common/random/sequence.h"
#include "render/frame/compare.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "render/frame/pixel_filter.h"
#include "render/frame/pixel_sum.h"
#include "render/frame/progressive.h"
#include "render/frame/target_error.h"
#include "tests/support/plain_set.h"
#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

constexpr std::array kKinds{FilterKind::box, FilterKind::gaussian, FilterKind::blackmanHarris};

/// p-value that offsets are distributed as a filter of some width.
double offsetPValue(const PixelFilter& sampled, FilterKind kind, double width) {
    constexpr int kBins = 32, kSamples = 200000;
    constexpr double kReach = 2.5;
    std::vector<double> observed(kBins), expected(kBins);
    for (int i = 0; i < kSamples; ++i) {
        const double u = toUnit(hashWords(7, static_cast<std::uint64_t>(i)));
        const double place = (sampled.offset(u) + kReach) / (2 * kReach) * kBins;
        ++observed[static_cast<std::size_t>(place)];
    }
    double total = 0;
    constexpr int kSteps = 64;
    for (int i = 0; i < kBins * kSteps; ++i) {
        const double at = ((i + 0.5) / (kBins * kSteps) * 2 - 1) * kReach;
        const double value = filterValue(kind, width, at);
        expected[static_cast<std::size_t>(i / kSteps)] += value;
        total += value;
    }
    for (double& value : expected) value *= kSamples / total;
    return test::chiSquaredPValue(observed, expected);
}

TEST(RunSpread, IsTheVarianceOfTheMeanOfKnownValues) {
    RunSpread alone, pairs;
    for (const double value : {1.0, 2.0, 4.0, 9.0}) {
        alone.add(value, 1);
        pairs.add(value, 2);
    }
    EXPECT_DOUBLE_EQ(alone.varianceOfMean(1, 4), 38.0 / 3 / 4);
    // Means of the runs are 1.5 and 6.5.
    EXPECT_DOUBLE_EQ(pairs.varianceOfMean(2, 4), 12.5 / 2);
}

TEST(PixelSum, AddsWhatTheSpreadOfCameraRaysDoesNotShow) {
    PixelSum sum;
    sum.cameraRays = 4;
    sum.values.coverage = 4;
    for (const double value : {1.0, 2.0, 4.0, 9.0}) sum.irradiance.add(value, 1);
    sum.variance = 5;
    const auto pixel = [&](float covariance) {
        sum.covariance = covariance;
        return sum.average({1, Rgb(0, 1, 0)});
    };
    EXPECT_FLOAT_EQ(pixel(0).variance, 38.0f / 3 / 4);
    EXPECT_FLOAT_EQ(pixel(8).variance, 38.0f / 3 / 4 + 8 / (4 * 3.0f));
    EXPECT_FLOAT_EQ(pixel(-80).variance, 0);
    EXPECT_FLOAT_EQ(pixel(0).sampleVariance, 5 / 16.0f);
    EXPECT_FLOAT_EQ(pixel(8).sampleVariance, (5 + 8) / 16.0f);
}

// The same value in each camera ray that meets the set has no spread.
TEST(PixelSum, VarianceOfColorAtAnEdgeIsThatOfTheRaysThatMeetTheSet) {
    PixelSum sum;
    sum.cameraRays = 4;
    sum.values.coverage = 2;
    sum.values.diffuseAlbedo = Rgb(1, 1, 1);  // of two hits
    sum.covariance = 6;
    const double reflectance = 0.5 / kPi;
    EXPECT_NEAR(sum.average({1, Rgb(0, 1, 0)}).colorVariance,
                reflectance * reflectance * 6 / (4 * 3), 1e-6);
}

TEST(PixelFilter, OffsetsAreDistributedAsTheFilter) {
    for (const FilterKind kind : kKinds)
        for (const double width : {1.25, 2.5}) {
            if (kind != FilterKind::box && width > 1.5) continue;  // would leave the histogram
            const PixelFilter filter(kind, width);
            EXPECT_GT(offsetPValue(filter, kind, width), test::significance(4));
            // Control: a filter 3 % wider.
            EXPECT_LT(offsetPValue(filter, kind, 1.03 * width), test::significance(4));
        }
}

TEST(PixelFilter, HasTheMomentsOfBlendersFilters) {
    const auto deviation = [](FilterKind kind, double width) {
        const PixelFilter filter(kind, width);
        constexpr int kSteps = 100000;
        double sum = 0, squares = 0;
        for (int i = 0; i < kSteps; ++i) {
            const double x = filter.offset((i + 0.5) / kSteps);
            EXPECT_LE(std::abs(x), filter.radius());
            sum += x / kSteps;
            squares += x * x / kSteps;
        }
        EXPECT_NEAR(sum, 0, 1e-9);
        return std::sqrt(squares);
    };
    EXPECT_NEAR(deviation(FilterKind::box, 2), 2 / std::sqrt(12.0), 1e-4);
    EXPECT_NEAR(deviation(FilterKind::gaussian, 1.5), 1.5 / 4, 1e-4);
    // Variance of a window a0 + a1 cos + a2 cos 2 + a3 cos 3 of radius r, by parts:
    // r^2 (1 / 3 + sum of 4 (-1)^k a_k / (2 a0 (k pi)^2) (-1)^k) with all signs positive.
    const double a0 = 0.35875, a[] = {0.48829, 0.14128, 0.01168};
    double variance = 1.0 / 3;
    for (int k = 1; k <= 3; ++k)
        variance += 2 * (k % 2 ? -1.0 : 1.0) * a[k - 1] / (a0 * k * k * kPi * kPi);
    EXPECT_NEAR(deviation(FilterKind::blackmanHarris, 1.5), 1.5 * std::sqrt(variance), 1e-4);
    // Control: the window half as wide.
    EXPECT_GT(std::abs(deviation(FilterKind::blackmanHarris, 0.75) - 1.5 * std::sqrt(variance)),
              0.1);
}

TEST(PixelFilter, OfABoxIsThePixelItself) {
    const PixelFilter filter(FilterKind::box, 0);
    for (const double u : {0.0, 0.125, 0.71, 0.999}) EXPECT_EQ(filter.offset(u), u - 0.5);
}

/// A frame of the plain with boxes.
class Frame : public testing::Test {
protected:
    Film render(const std::string& estimator = "mis", int number = 1) {
        const auto made = findEstimator(estimator).make({scene_, environment_, nullptr, sequence_});
        RenderStats stats;
        return shadowcache::render({*made, camera_, number, options_}, stats);
    }

    Frame() {
        options_.width = 48;
        options_.height = 32;
        options_.samples = 2;
        options_.cameraRays = 4;
    }

    const TriangleMesh mesh_ = test::plainMesh();
    const Scene scene_{mesh_};
    Environment environment_ = test::environmentOf(test::noiseMap(64, 32, 5), 30);
    Camera camera_ = lookAt({0.9, 1.3, 1.6}, {0, 0, 0.1}, {0, 1, 0}, 0.9);
    Sequence sequence_ = Sequence::kSobol;
    RenderOptions options_;
};

TEST_F(Frame, CropShowsWhatTheWholeFrameShows) {
    const Film whole = render();
    const FilmRectangle crop{13, 7, 19, 21};
    options_.crop = crop;
    const auto differences = [&](const Film& film) {
        int different = 0;
        for (int y = 0; y < crop.height; ++y)
            for (int x = 0; x < crop.width; ++x) {
                const Pixel& a = film.pixels[static_cast<std::size_t>(y * crop.width + x)];
                const Pixel& b =
                    whole.pixels[static_cast<std::size_t>((y + crop.y) * whole.width + x + crop.x)];
                different += a.color != b.color || a.variance != b.variance || a.rays != b.rays;
            }
        return different;
    };
    const Film part = render();
    ASSERT_EQ(part.width, crop.width);
    ASSERT_EQ(part.height, crop.height);
    EXPECT_EQ(differences(part), 0);
    // Control: a part beside it.
    options_.crop->x += 1;
    EXPECT_GT(differences(render()), 100);
}

TEST_F(Frame, OfAnotherNumberHasOtherNoise) {
    const Film first = render("mis", 1);
    const auto differences = [&](const Film& film) {
        int different = 0;
        for (std::size_t i = 0; i < film.pixels.size(); ++i)
            different += film.pixels[i].color != first.pixels[i].color;
        return different;
    };
    const auto lit = std::ranges::count_if(first.pixels, [](const Pixel& p) { return p.rays > 0; });
    ASSERT_GT(lit, 300);
    EXPECT_GT(differences(render("mis", 2)), lit / 2);
    // Control: the same number.
    EXPECT_EQ(differences(render("mis", 1)), 0);
}

/// p-value that `scale` times what pixels say of their variance is what they have, over renders
/// with several seeds.
double variancePValue(const std::vector<Film>& films, double scale) {
    std::vector<double> differences;
    const auto count = static_cast<double>(films.size());
    for (std::size_t i = 0; i < films.front().pixels.size(); ++i) {
        double sum = 0, squares = 0, told = 0;
        for (const Film& film : films) {
            const Pixel& pixel = film.pixels[i];
            const auto value = static_cast<double>(luminance(pixel.color));
            sum += value;
            squares += value * value;
            told += static_cast<double>(pixel.colorVariance) / count;
        }
        const double variance = (squares - sum * sum / count) / (count - 1);
        differences.push_back(scale * told - variance);
    }
    return test::meanPValue(differences, 0);
}

TEST_F(Frame, PixelsKnowTheirVariance) {
    // One constant plane: no edge, whose stratified rays vary less than their spread tells.
    camera_ = lookAt({0, 3, 0.01}, {0, 0, 0}, {0, 0, -1}, 0.2);
    sequence_ = Sequence::kRandom;
    options_.width = options_.height = 24;
    options_.samples = 1;
    for (const int rays : {2, 3, 16}) {
        options_.cameraRays = rays;
        std::vector<Film> films;
        for (options_.seed = 1; options_.seed <= 40; ++options_.seed)
            films.push_back(render("cosine"));
        EXPECT_GT(variancePValue(films, 1), test::significance(3)) << rays;
        // Control: 10 % too much.
        EXPECT_LT(variancePValue(films, 1.1), test::significance(3)) << rays;
    }
}

TEST_F(Frame, VarianceOfAPixelCountsEdges) {
    environment_ = test::environmentOf(test::constantMap(Rgb(1)));
    camera_ = lookAt({0, 0.3, 4}, {0, 0.2, 0}, {0, 1, 0}, 0.5);
    options_.cameraRays = 64;
    options_.samples = 64;
    const Film film = render();
    double edges = 0, sky = 0;
    int edgePixels = 0, skyPixels = 0;
    for (const Pixel& pixel : film.pixels) {
        const auto variance = static_cast<double>(pixel.colorVariance);
        // The sky has no albedo, the set has 0.5.
        if (pixel.albedo.y == 0) {
            sky += variance;
            ++skyPixels;
        } else if (pixel.albedo.y > 0.1f && pixel.albedo.y < 0.4f) {
            edges += variance;
            ++edgePixels;
        }
    }
    ASSERT_GT(skyPixels, 50);
    ASSERT_GT(edgePixels, 10);
    EXPECT_EQ(sky, 0);
    // Of radiances 1 and about 0.5 in turns: some 0.06 a ray; stratification takes most of it.
    EXPECT_GT(edges / edgePixels, 1e-5);
    EXPECT_LT(edges / edgePixels, 0.06 / 64);
}

/// Whether two films have the same bits.
bool same(const Film& a, const Film& b) {
    return std::ranges::equal(a.pixels, b.pixels, [](const Pixel& p, const Pixel& q) {
        return p.color == q.color && p.variance == q.variance && p.rays == q.rays;
    });
}

class Progressive : public Frame {
protected:
    Progressive() {
        BakeOptions bakeOptions;
        bakeOptions.spacing = 0.25;
        bakeOptions.level = 3;
        cache_.emplace(bake(scene_, bakeOptions));
    }

    /// Passes until `passes` are complete.
    ProgressiveFrame progress(const std::string& name, int passes) {
        const auto made =
            findEstimator(name).make({scene_, environment_, &cache_->cache(), sequence_});
        RenderStats stats;
        std::atomic<int> complete{0};
        ProgressiveObserver observer;
        observer.stop = [&] { return complete >= passes; };
        observer.onPass = [&](const Film&, int) { ++complete; };
        FrameRequest frame{*made, camera_, 1, options_};
        frame.plan = planFrame(frame, stats);
        return renderProgressive(frame, stats, observer);
    }
    Film atOnce(const std::string& name) {
        const auto made =
            findEstimator(name).make({scene_, environment_, &cache_->cache(), sequence_});
        RenderStats stats;
        FrameRequest frame{*made, camera_, 1, options_};
        frame.plan = planFrame(frame, stats);
        return shadowcache::render(frame, stats);
    }

    std::optional<test::TestCache> cache_;
};

TEST_F(Progressive, PassesMakeTheBitsOfAllAtOnce) {
    options_.passRays = 4;
    for (const char* name : {"mis", "cache"}) {
        options_.cameraRays = 16;
        const ProgressiveFrame all = progress(name, 99);
        EXPECT_EQ(all.cameraRays, 16);
        EXPECT_EQ(all.end, FrameEnd::complete);
        EXPECT_TRUE(same(all.film, atOnce(name))) << name;
        const ProgressiveFrame some = progress(name, 2);
        EXPECT_EQ(some.cameraRays, 8);
        EXPECT_EQ(some.end, FrameEnd::stopped);
        // Control: it is not the whole one.
        EXPECT_FALSE(same(some.film, all.film)) << name;
        options_.cameraRays = 8;
        EXPECT_TRUE(same(some.film, atOnce(name))) << name;
        // The first pass is completed whatever happens.
        EXPECT_EQ(progress(name, 0).cameraRays, 4);
    }
}

/// The target is met within a factor, edges included, for estimators of very different noise; with
/// rays where they are needed.
TEST_F(Progressive, TargetErrorIsMet) {
    options_.cameraRays = 128;
    options_.samples = 16;
    options_.seed = 77;
    const Image reference = colorImage(atOnce("cache"));
    options_.samples = 4;
    constexpr int kSeeds = 4;  // so small a picture has one tile that is checked: it decides alone
    for (const char* name : {"mis", "cache"})
        for (const double target : {0.02, 0.002}) {
            const auto made =
                findEstimator(name).make({scene_, environment_, &cache_->cache(), sequence_});
            double error = 0, told = 0, cameraRays = 0;
            for (options_.seed = 1; options_.seed <= kSeeds; ++options_.seed) {
                RenderStats stats;
                const auto [frame, correction] =
                    planForError(FrameRequest{*made, camera_, 1, options_}, target, stats);
                const Film film = shadowcache::render(frame, stats);
                error += relativeError(colorImage(film), reference).mean / kSeeds;
                told += correction * measuredError(film.pixels, environment_.luminanceWeights()) /
                        kSeeds;
                cameraRays += meanCameraRays(film) / kSeeds;
                const auto [least, most] = std::ranges::minmax(frame.tileRays);
                if (most > 16) {
                    EXPECT_LT(least, most) << name << ' ' << target;
                }
            }
            // Four camera rays, the fewest, may do better.
            if (cameraRays > 5) {
                EXPECT_GT(error, target / 4) << name << ' ' << target;
            }
            EXPECT_LT(error, 3 * target) << name << ' ' << target;
            EXPECT_LT(told, 3 * error) << name << ' ' << target;
            EXPECT_GT(told, error / 3) << name << ' ' << target;
        }
}

}  // namespace
}  // namespace shadowcache
