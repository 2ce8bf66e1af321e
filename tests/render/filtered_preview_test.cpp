// Pictures of --preview: nearer to the truth than the prediction and than the estimate, the nearer
// the more rays; the same bits in parts, in passes and for any number of threads.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "common/base/parallel.h"
#include "render/frame/compare.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "render/frame/progressive.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

/// A floor with a slab and a ball above it, seen from the side; a part of the picture is sky.
TriangleMesh slabAndBall() {
    TriangleMesh mesh = test::slabMesh();
    test::addSphere(mesh, {-0.6f, 0.3f, 0.3f}, 0.3f, 24);
    return mesh;
}

class FilteredPreview : public testing::Test {
protected:
    ~FilteredPreview() override { setThreadCount(0); }

    FilteredPreview() {
        options_.width = 64;
        options_.height = 40;
        options_.samples = 1;
        options_.cameraRays = 4;
        options_.preview = true;
    }

    FrameRequest request(Estimator& estimator) const {
        return {estimator, lookAt({-1.8, 1.1, 2.8}, {0, 0.3, 0}, {0, 1, 0}, 0.8), 1, options_};
    }

    Film render() const {
        const auto estimator = findEstimator("cache").make(world_.context());
        FrameRequest frame = request(*estimator);
        RenderStats stats;
        frame.plan = planFrame(frame, stats);
        if (sameRays_ && frame.plan.antialiasing) frame.plan.antialiasing->most = 1;
        return shadowcache::render(frame, stats);
    }
    Film withoutFilter(int samples) {
        const RenderOptions kept = options_;
        options_.preview = false;
        options_.samples = samples;
        Film film = render();
        options_ = kept;
        return film;
    }

    static double error(const Film& film, const Film& reference) {
        return relativeError(colorImage(film), colorImage(reference)).mean;
    }

    const test::World world_{slabAndBall(), test::noiseMap(64, 32, 5)};
    RenderOptions options_;
    bool sameRays_ = false;  ///< the same camera rays whatever the samples: edges make no error
};

/// Pixels of `part` that differ from those of `whole`.
int differences(const Film& part, const Film& whole) {
    int different = 0;
    for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x) {
            const auto at = [&](const Film& film) {
                return film.pixels[static_cast<std::size_t>((y + part.y - film.y) * film.width + x +
                                                            part.x - film.x)];
            };
            const Pixel a = at(part), b = at(whole);
            different += a.color != b.color || a.colorVariance != b.colorVariance;
        }
    return different;
}

TEST_F(FilteredPreview, IsNearerToTheTruthThanPredictionAndEstimate) {
    sameRays_ = true;
    const Film reference = withoutFilter(1024);
    const double filtered = error(render(), reference);
    EXPECT_LT(filtered, 0.6 * error(withoutFilter(1), reference));
    EXPECT_LT(filtered, 0.9 * error(withoutFilter(0), reference));
}

TEST_F(FilteredPreview, IsConsistent) {
    sameRays_ = true;
    const std::array numbers{1, 4, 16, 64};
    std::array<double, 4> errors{};  // over seeds: with one, a few pixels decide
    double predicted = 0;
    for (options_.seed = 1; options_.seed <= 4; ++options_.seed) {
        const Film reference = withoutFilter(512);
        predicted += error(withoutFilter(0), reference);
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            options_.samples = numbers[i];
            errors[i] += error(render(), reference);
        }
    }
    for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_LT(errors[i], 0.6 * errors[i - 1]) << i;
    // Control: the prediction alone stays where it is.
    EXPECT_GT(predicted, 10 * errors.back());
}

TEST_F(FilteredPreview, LeavesTheSkyAlone) {
    sameRays_ = true;
    const Film filtered = render(), plain = withoutFilter(1);
    int sky = 0, changed = 0;
    for (std::size_t i = 0; i < plain.pixels.size(); ++i) {
        const bool same = filtered.pixels[i].color == plain.pixels[i].color;
        if (plain.pixels[i].coverage > 0) {
            changed += !same;
            continue;
        }
        ++sky;
        EXPECT_TRUE(same) << i;
    }
    EXPECT_GT(sky, 100);
    EXPECT_GT(changed, 1000);
}

TEST_F(FilteredPreview, CropShowsWhatTheWholeShows) {
    const Film whole = render();
    for (const FilmRectangle& crop : {FilmRectangle{20, 12, 13, 9}, FilmRectangle{0, 31, 64, 9}}) {
        options_.crop = crop;
        const Film part = render();
        EXPECT_EQ(part.width, crop.width);
        EXPECT_EQ(part.height, crop.height);
        EXPECT_EQ(differences(part, whole), 0);
    }
    // Control: another seed is seen.
    ++options_.seed;
    EXPECT_GT(differences(render(), whole), 100);
}

TEST_F(FilteredPreview, PassesAndThreadsChangeNoBit) {
    options_.passRays = 2;
    const Film whole = render();
    const auto estimator = findEstimator("cache").make(world_.context());
    FrameRequest frame = request(*estimator);
    RenderStats stats;
    frame.plan = planFrame(frame, stats);
    ProgressiveObserver observer;
    int passes = 0;
    observer.onPass = [&](const Film& film, int) {
        ++passes;
        EXPECT_EQ(film.width, whole.width);
        EXPECT_GT(differences(film, whole), 100);
    };
    EXPECT_EQ(differences(renderProgressive(frame, stats, observer).film, whole), 0);
    EXPECT_EQ(passes, 1);
    setThreadCount(1);
    EXPECT_EQ(differences(render(), whole), 0);
}

}  // namespace
}  // namespace shadowcache
