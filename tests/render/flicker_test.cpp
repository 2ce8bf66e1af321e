// Over the frames of a slow move the cache's pictures are calmer than those of `mis`, and each
// frame's noise is its own.

#include "tests/support/flicker.h"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache::test {
namespace {

constexpr int kFrames = 48;

/// A floor with columns under a roof, open to one side.
TriangleMesh porch() {
    TriangleMesh mesh;
    addFloor(mesh, 0, -3, 3, -3, 3);
    addBox(mesh, {-3, 2, -3}, {3, 2.2f, 1});
    addBox(mesh, {-3, 0, -3.2f}, {3, 2, -3});
    for (const float x : {-2.5f, -1.0f, 0.5f, 2.0f}) addBox(mesh, {x, 0, 0.7f}, {x + 0.3f, 2, 1});
    return mesh;
}

std::vector<Camera> slowMove() {
    std::vector<Camera> cameras;
    cameras.reserve(kFrames);
    for (int i = 0; i < kFrames; ++i)
        cameras.push_back(
            lookAt({-1 + 0.015 * i, 1.4, 4.5}, {0.015 * i, 0.5, -1}, Vec3d(0, 1, 0), 0.9));
    return cameras;
}

class Flicker : public testing::Test {
protected:
    Flicker() {
        options_.width = 48;
        options_.height = 27;
        options_.samples = 16;
        std::iota(numbers_.begin(), numbers_.end(), 1);
        RenderOptions best = options_;
        best.samples = 128;
        best.seed = 2;
        RenderStats unused;
        reference_ = renderShot(context_, "cache", cameras_, numbers_, best, unused);
        places_ = trackPlaces(context_, cameras_, options_);
        brightness_ = brightness(reference_, places_);
    }

    static BakeResult bakeOf(const Scene& scene) {
        BakeOptions options;
        options.spacing = 0.25;
        options.level = 3;
        return bake(scene, options);
    }

    ShotLight shotOf(const char* estimator, const std::vector<int>& numbers) const {
        RenderStats unused;
        return renderShot(context_, estimator, cameras_, numbers, options_, unused);
    }
    std::vector<double> found(const ShotLight& shot, const Places& places) const {
        return correlations(errorsOf(shot, reference_), places, brightness_);
    }

    const TriangleMesh mesh_ = porch();
    const Scene scene_{mesh_};
    const Environment environment_ = environmentOf(noiseMap(32, 16, 5));
    const TestCache cache_{bakeOf(scene_)};
    const EstimatorContext context_{scene_, environment_, &cache_.cache(), {}};
    const std::vector<Camera> cameras_ = slowMove();
    std::vector<int> numbers_ = std::vector<int>(kFrames);
    RenderOptions options_;
    ShotLight reference_;
    Places places_;
    std::vector<double> brightness_;
};

TEST_F(Flicker, IsLessWithTheCache) {
    ASSERT_GT(places_.count(), 300u);
    const ShotLight mis = shotOf("mis", numbers_), cache = shotOf("cache", numbers_);
    const auto variance = [&](const ShotLight& shot) {
        return temporalVariance(shot, places_, brightness_);
    };
    EXPECT_LT(variance(cache), variance(mis));
    // Without what the move itself does.
    EXPECT_LT(variance(errorsOf(cache, reference_)), variance(errorsOf(mis, reference_)) / 4);
}

TEST_F(Flicker, EachFrameHasNoiseOfItsOwn) {
    for (const char* estimator : {"mis", "cache"}) {
        const ShotLight shot = shotOf(estimator, numbers_);
        EXPECT_GT(meanPValue(found(shot, places_), 0), significance(2)) << estimator;
        EXPECT_GT(meanPValue(found(shot, samePixels(places_)), 0), significance(2)) << estimator;
    }
}

// Control: with the same numbers in every frame the noise sticks to the screen. That of `cache`
// less: its clusters, and with them the numbers that a pixel draws, follow what the camera sees.
TEST_F(Flicker, SeesNoiseThatSticksToTheScreen) {
    const std::vector<int> stuck(kFrames, 1);
    const auto pValue = [&](const char* estimator) {
        return meanPValue(found(shotOf(estimator, stuck), samePixels(places_)), 0);
    };
    EXPECT_LT(pValue("mis"), significance(2));
    EXPECT_LT(pValue("cache"), significance(2));
}

// Control: on a still camera the same numbers give the same picture.
TEST_F(Flicker, SameNumbersOnAStillCameraCorrelateFully) {
    const std::vector<Camera> still(kFrames, cameras_.front());
    const std::vector<int> stuck(kFrames, 1);
    RenderStats unused;
    const ShotLight shot = renderShot(context_, "cache", still, stuck, options_, unused);
    const ShotLight errors = errorsOf(shot, ShotLight(kFrames, reference_.front()));
    for (const double r : correlations(errors, samePixels(places_), brightness_))
        EXPECT_NEAR(r, 1, 1e-9);
}

}  // namespace
}  // namespace shadowcache::test
