// Pixels whose camera rays are predicted to differ get more of them: which, that it adds no bias,
// and what it gains.

#include "render/frame/antialiasing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "render/frame/pilot.h"
#include "render/frame/progressive.h"
#include "tests/support/plain_set.h"
#include "tests/support/statistics.h"

namespace shadowcache {
namespace {

constexpr int kSide = 8;

std::vector<FilmPlace> square() {
    std::vector<FilmPlace> places;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) places.push_back({x + 100, y + 50});
    return places;
}

PredictedSpread spreadOf(std::initializer_list<double> luminances) {
    PredictedSpread spread;
    for (const double luminance : luminances) spread.add(luminance, 0);
    return spread;
}

std::vector<int> factorsOf(const std::vector<PredictedSpread>& spreads,
                           const AntialiasingRule& rule) {
    std::vector<int> factors;
    for (const PredictedSpread& pixel : withNeighbors(square(), spreads))
        factors.push_back(rateOf(pixel, rule).rayFactor);
    return factors;
}

// What emits gets rays of its own, and no camera rays.
TEST(Antialiasing, LooksForWhatEmitsByRaysOfItsOwn) {
    PredictedSpread lamp, even;
    lamp.add(1, 0);
    lamp.add(1, 9);
    even.add(1, 4);
    even.add(1, 4);
    const auto rays = [](const PredictedSpread& pixel, const AntialiasingRule& rule) {
        const AdaptiveRate rate = rateOf(pixel, rule);
        return std::pair(rate.rayFactor, rate.emissionFactor);
    };
    const AntialiasingRule rule{0, 0.02, 16, 64};
    EXPECT_EQ(rays(lamp, rule), std::pair(1, 16));
    EXPECT_EQ(rays(even, rule), std::pair(1, 0));
    EXPECT_EQ(rays(lamp, {0, 0.02, 16, 8}), std::pair(1, 8));
    EXPECT_EQ(rays(lamp, {0, 1e3, 16, 64}), std::pair(1, 0));
    EXPECT_EQ(rays(lamp, {0, 0.02, 16, 1}), std::pair(8, 0));
    // An edge of a surface nearly as bright as the sky: each part alone varies more than both.
    PredictedSpread faint;
    faint.add(0.9, 0);
    faint.add(0, 1);
    EXPECT_EQ(rays(faint, rule), std::pair(1, 0));
}

/// Bright on the left, dark on the right, both in column `edge`.
std::vector<PredictedSpread> edgeAt(int edge) {
    std::vector<PredictedSpread> spreads;
    for (const FilmPlace& place : square()) {
        const int x = place.x - 100;
        spreads.push_back(x < edge    ? spreadOf({1, 1})
                          : x == edge ? spreadOf({1, 0.1})
                                      : spreadOf({0.1, 0.1}));
    }
    return spreads;
}

TEST(Antialiasing, OfAPixelFollowsWhatItsCameraRaysSee) {
    const std::vector<FilmPlace> places = square();
    const std::vector<int> factors = factorsOf(edgeAt(4), {0, 0.02});
    for (std::size_t i = 0; i < places.size(); ++i) {
        const int distance = std::abs(places[i].x - 104);
        if (distance == 0) {
            EXPECT_EQ(factors[i], 4);
        } else if (distance > 1) {
            EXPECT_EQ(factors[i], 1);
        }
    }
    // Control: what does not pay gets none.
    for (const int factor : factorsOf(edgeAt(4), {0, 2})) EXPECT_EQ(factor, 1);
    // In the dark, absolute errors count.
    for (const int factor : factorsOf(edgeAt(4), {1e3, 0.02})) EXPECT_EQ(factor, 1);
}

TEST(Antialiasing, PaysByTheFramesErrorAndTheCostOfSamples) {
    const std::vector<PredictedSpread> flat(16, spreadOf({2, 2})), rough(16, spreadOf({1, 3}));
    EXPECT_DOUBLE_EQ(makeAntialiasingRule(spreadOf(flat), 0.1, 16, 4).floor, 0.04);
    const double least = makeAntialiasingRule(spreadOf(flat), 0.1, 16, 4).least;
    EXPECT_GT(least, 0);
    EXPECT_DOUBLE_EQ(makeAntialiasingRule(spreadOf(flat), 0.2, 16, 4).least, 2 * least);
    // A noisier frame gains less by the same pixel, and so does one whose samples cost little.
    EXPECT_GT(makeAntialiasingRule(spreadOf(rough), 0.1, 16, 4).least, least);
    EXPECT_GT(makeAntialiasingRule(spreadOf(flat), 0.1, 16, 1).least, least);
    EXPECT_LT(makeAntialiasingRule(spreadOf(flat), 0.1, 16, 16).least, least);
}

// What the rays of all pixels leave and cost is what the rule weighs those of one against: no other
// threshold makes less of error times cost.
TEST(Antialiasing, LeavesTheLeastErrorForItsCost) {
    constexpr double kLight = 0.01, kSampleCost = 0.4;
    constexpr int kCameraRays = 16;
    FrameSpread frame;
    for (int i = 0; i < 4096; ++i) {
        const double v = std::exp2(i / 256.0 - 20);
        frame.variances.push_back({v, v, 0});
    }
    const AntialiasingRule rule = makeAntialiasingRule(frame, kLight, kCameraRays, 4);
    const auto product = [&](double least) {
        double error = kLight / kCameraRays, cost = kSampleCost * 4;
        for (const PixelVariances& pixel : frame.variances) {
            const double v = pixel.all;
            int factor = 1;
            while (2 * factor <= rule.most && v > std::pow(factor, 1 + kStratification) * least)
                factor *= 2;
            error += v / std::pow(kCameraRays * factor, kStratification) / 4096;
            cost += factor / 4096.0;
        }
        return error * cost;
    };
    const double best = product(rule.least);
    for (const double other : {0.25, 0.5, 2.0, 4.0})
        EXPECT_GT(product(other * rule.least), 1.002 * best) << other;
}

// Where all pixels are rough, many more rays would pay: users still get about what they ask for.
TEST(Antialiasing, StaysNearWhatIsAskedForOnTheMean) {
    FrameSpread frame;
    for (int i = 0; i < 256; ++i) {
        const double v = std::exp2(i / 64.0);
        frame.variances.push_back({v, v, 0});
    }
    const auto meanFactor = [&](const AntialiasingRule& rule) {
        double sum = 0;
        for (const PixelVariances& pixel : frame.variances) {
            PredictedSpread spread;
            const double deviation = std::sqrt(pixel.all);
            spread.add(1 + deviation, 0);
            spread.add(1 - deviation, 0);
            sum += rateOf(spread, rule).rayFactor / 256.0;
        }
        return sum;
    };
    AntialiasingRule rule = makeAntialiasingRule(frame, 1e-6, 16, 4);
    EXPECT_LE(meanFactor(rule), 1.25);
    EXPECT_GT(meanFactor(rule), 1);
    // Control: a rule that is a tenth as strict.
    rule.least /= 10;
    EXPECT_GT(meanFactor(rule), 1.25);
}

TEST(Antialiasing, MakesNoMoreCameraRaysThanCanBeSeen) {
    const FrameSpread rough = spreadOf(std::vector<PredictedSpread>(16, spreadOf({1, 3})));
    EXPECT_EQ(makeAntialiasingRule(rough, 0.1, 4, 16).most, 16);
    EXPECT_EQ(makeAntialiasingRule(rough, 0.1, 16, 4).most, 16);
    EXPECT_EQ(makeAntialiasingRule(rough, 0.1, 64, 1).most, 4);
    EXPECT_EQ(makeAntialiasingRule(rough, 0.1, 4096, 1).most, 4);
    // A pixel never gets more.
    const std::vector<int> factors = factorsOf(edgeAt(4), {0, 1e-9, 8});
    EXPECT_EQ(*std::ranges::max_element(factors), 8);
}

/// A small frame of boxes on a plain before a bright sky.
class AntialiasedFrame : public testing::Test {
protected:
    AntialiasedFrame() {
        options_.width = 24;
        options_.height = 16;
        options_.filter = FilterKind::box;
    }

    /// Films of seeds of their own after one pilot.
    std::vector<Film> films(int count, bool adaptive) {
        return adaptive ? films(count, {}, {}) : films(count, 1, 1);
    }

    /// @param most, mostEmission  of the AntialiasingRule; none: the frame's own
    std::vector<Film> films(int count, std::optional<int> most, std::optional<int> mostEmission) {
        const auto estimator = findEstimator("cache").make({scene_, environment_, &cache_.cache()});
        FrameRequest frame{*estimator, camera_, 1, options_};
        RenderStats stats;
        frame.options.seed = 1000;
        frame.plan = planFrame(frame, stats);
        EXPECT_TRUE(frame.plan.antialiasing);
        AntialiasingRule& rule = *frame.plan.antialiasing;
        rule.most = most.value_or(rule.most);
        rule.mostEmission = mostEmission.value_or(rule.mostEmission);
        std::vector<Film> all;
        for (frame.options.seed = 1; static_cast<int>(all.size()) < count; ++frame.options.seed)
            all.push_back(render(frame, stats));
        return all;
    }

    /// Calls `work` with the frame that films() renders first.
    template <class Work>
    auto withFirstFrame(const Work& work) {
        const auto estimator = findEstimator("cache").make({scene_, environment_, &cache_.cache()});
        FrameRequest frame{*estimator, camera_, 1, options_};
        RenderStats stats;
        frame.options.seed = 1000;
        frame.plan = planFrame(frame, stats);
        frame.options.seed = 1;
        return work(frame, stats);
    }

    Pixel pixel(int x, int y) {
        return withFirstFrame([&](const FrameRequest& frame, RenderStats&) {
            return renderPixel(frame, x, y, [](const CameraSample&) {});
        });
    }

    /// Own samples of points of one place, all with the same error scale.
    double raysOf(float errorScale) {
        return withFirstFrame([&](const FrameRequest& frame, RenderStats&) {
            std::vector<ShadingPoint> points;
            const ShadingPoint place = test::pointAlong(scene_, {0.2f, 1, 0.1f}, {0, -1, 0});
            for (std::uint32_t i = 0; i < 256; ++i) {
                ShadingPoint& point = points.emplace_back(place);
                point.slot.seed = hashWords(i);
                point.slot.pixel = i;
                point.slot.errorScale = errorScale;
            }
            std::vector<Estimate> estimates(points.size());
            const auto workspace = frame.estimator.makeWorkspace();
            frame.estimator.estimate({.points = points,
                                      .samples = frame.options.samples,
                                      .pixels = 256,
                                      .plan = frame.plan.estimator.get()},
                                     *workspace, estimates);
            double rays = 0;
            for (const Estimate& e : estimates) rays += e.rays;
            return rays;
        });
    }

    Film inPasses() {
        return withFirstFrame([](const FrameRequest& frame, RenderStats& stats) {
            return renderProgressive(frame, stats, {[] { return false; }, [](const Film&, int) {}})
                .film;
        });
    }

    RenderOptions options_;

private:
    static BakeResult bakeOf(const Scene& scene) {
        BakeOptions options;
        options.spacing = 0.25;
        options.level = 3;
        return bake(scene, options);
    }

    const TriangleMesh mesh_ = test::plainMesh();
    const Scene scene_{mesh_};
    const Environment environment_ = test::environmentOf(test::noiseMap(64, 32, 5), 30);
    const test::TestCache cache_{bakeOf(scene_)};
    const Camera camera_ = lookAt({0.9, 0.5, 1.6}, {0, 0.1, 0.1}, {0, 1, 0}, 0.9);
};

double value(const Pixel& pixel) {
    return static_cast<double>(luminance(pixel.color));
}

/// Mean over films of a pixel.
double meanOf(const std::vector<Film>& films, std::size_t pixel) {
    double sum = 0;
    for (const Film& film : films) sum += value(film.pixels[pixel]);
    return sum / static_cast<double>(films.size());
}

// A dark place in a bright pixel gets fewer samples, a bright one in a dark pixel more.
TEST_F(AntialiasedFrame, SharesSamplesOutByWhatThePixelShows) {
    options_.cameraRays = 4;
    options_.samples = 16;
    EXPECT_NEAR(raysOf(2) / raysOf(1), 0.5, 0.05);
    EXPECT_NEAR(raysOf(0.5f) / raysOf(1), 2, 0.2);
    // Control: without a pixel, its own brightness decides. A quarter is the least; samples below
    // the horizon have no ray.
    EXPECT_GT(raysOf(0), raysOf(1e6f));
    EXPECT_NEAR(raysOf(1e6f) / (256 * 4), 0.95, 0.05);
}

/// Whether a pixel shows both the set and the sky.
bool isEdge(const Pixel& pixel) {
    return pixel.coverage > 0 && pixel.coverage < 1;
}

/// Camera rays of a pixel depend on what its neighbours and other rays of its own see, which must
/// not show in its mean, at the edges least of all; emission rays there neither.
TEST_F(AntialiasedFrame, PixelsWithMoreCameraRaysHaveTheSameMean) {
    options_.cameraRays = 256;
    options_.samples = 4;
    const std::vector<Film> truth = films(10, false);
    options_.cameraRays = 2;
    options_.samples = 1;
    const std::vector<Film> found = films(400, true);
    // The same pixels in each: those that have more in the first.
    const auto totalsOf = [&](const std::vector<Film>& films, double factor) {
        std::vector<double> totals;
        for (const Film& film : films) {
            double total = 0;
            for (std::size_t i = 0; i < film.pixels.size(); ++i)
                if (found.front().pixels[i].cameraRays > 2 || isEdge(truth.front().pixels[i]))
                    total += value(film.pixels[i]);
            totals.push_back(factor * total);
        }
        return totals;
    };
    const std::vector<double> totals = totalsOf(found, 1);
    ASSERT_GT(totals.front(), 0);
    EXPECT_GT(test::sameMeanPValue(totals, totalsOf(truth, 1)), test::significance(1));
    // Control: 1 % more.
    EXPECT_LT(test::sameMeanPValue(totals, totalsOf(truth, 1.01)), test::significance(1));
}

/// At edges before a bright sky cheap rays look for it, in place of camera rays that are lit.
TEST_F(AntialiasedFrame, FindsTheSkyAtEdgesWithoutMoreCameraRays) {
    options_.cameraRays = 256;
    options_.samples = 4;
    const std::vector<Film> truth = films(3, false);
    options_.cameraRays = 4;
    struct Found {
        double error = 0, cameraRays = 0, ownVariance = 0;
    };
    const auto measure = [&](int most, int mostEmission) {
        Found sum;
        for (const Film& film : films(12, most, mostEmission))
            for (std::size_t i = 0; i < film.pixels.size(); ++i) {
                if (!isEdge(truth.front().pixels[i])) continue;
                const double off = value(film.pixels[i]) - meanOf(truth, i);
                sum.error += off * off;
                sum.cameraRays += static_cast<double>(film.pixels[i].cameraRays);
                sum.ownVariance += static_cast<double>(film.pixels[i].colorVariance);
            }
        return sum;
    };
    const Found alike = measure(1, 1), cheap = measure(1, 256), camera = measure(4, 1);
    EXPECT_LT(cheap.error, 0.5 * alike.error);
    EXPECT_EQ(cheap.cameraRays, alike.cameraRays);
    // A pixel tells its error as well as without them: runs are less stratified than the whole.
    EXPECT_NEAR(cheap.ownVariance / cheap.error, alike.ownVariance / alike.error, 0.8);
    // Control: camera rays do as much at a greater cost.
    EXPECT_LT(camera.error, 0.7 * alike.error);
    EXPECT_GT(camera.cameraRays, 1.2 * alike.cameraRays);
}

TEST_F(AntialiasedFrame, HasLessErrorWithAsManySamples) {
    options_.width = 48;
    options_.height = 32;
    options_.cameraRays = 256;
    options_.samples = 4;
    const std::vector<Film> truth = films(3, false);
    options_.cameraRays = 4;
    struct Found {
        double error = 0, rays = 0, cameraRays = 0;
    };
    const auto measure = [&](bool adaptive) {
        Found sum;
        for (const Film& film : films(6, adaptive))
            for (std::size_t i = 0; i < film.pixels.size(); ++i) {
                const double mean = meanOf(truth, i), off = value(film.pixels[i]) - mean;
                sum.error += off * off / (mean * mean + 0.01);
                sum.rays += static_cast<double>(film.pixels[i].rays - film.pixels[i].reusedRays);
                sum.cameraRays += static_cast<double>(film.pixels[i].cameraRays);
            }
        return sum;
    };
    const Found alike = measure(false), adaptive = measure(true);
    EXPECT_LT(adaptive.error, 0.15 * alike.error);
    EXPECT_NEAR(adaptive.rays, alike.rays, 0.1 * alike.rays);
    // Not all pixels have more.
    EXPECT_LT(adaptive.cameraRays, 8 * alike.cameraRays);
}

/// Passes, crops, threads and replayed pixels see the same rays.
TEST_F(AntialiasedFrame, HasTheSameBitsHoweverItIsRendered) {
    options_.cameraRays = 16;
    options_.passRays = 8;
    const Film whole = films(1, true).front();
    const auto most = std::ranges::max_element(whole.pixels, {}, &Pixel::cameraRays);
    EXPECT_GE(most->cameraRays, 64);
    const auto same = [&](const Film& film) {
        for (int y = 0; y < film.height; ++y)
            for (int x = 0; x < film.width; ++x)
                if (film.pixels[static_cast<std::size_t>(y * film.width + x)].color !=
                    whole.pixels[static_cast<std::size_t>((y + film.y) * whole.width + x + film.x)]
                        .color)
                    return false;
        return true;
    };
    {
        const test::ThreadsOf one(1);
        EXPECT_TRUE(same(films(1, true).front()));
    }
    options_.crop = FilmRectangle{5, 3, 9, 8};
    EXPECT_TRUE(same(films(1, true).front()));
    options_.crop.reset();
    const auto number = static_cast<int>(most - whole.pixels.begin());
    EXPECT_EQ(pixel(number % whole.width, number / whole.width).color, most->color);
    EXPECT_TRUE(same(inPasses()));
    // Control: another seed.
    EXPECT_FALSE(same(films(2, true).back()));
}

}  // namespace
}  // namespace shadowcache
