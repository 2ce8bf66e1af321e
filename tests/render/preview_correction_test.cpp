// A preview without samples: right in the mean, by light group and in parts as in the whole.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "render/estimators/light_groups.h"
#include "render/frame/correction_field.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

using FieldPlace = CorrectionField::Place;

CheckedPlace lightOf(float predicted, float found) {
    return {.direct = {Rgb(predicted), Rgb(found)}, .indirect = {Rgb(1), Rgb(2)}};
}

/// Places all over a square, whose light `found` tells of x.
template <class Found>
std::vector<FieldPlace> square(const Vec3f& normal, const Found& found) {
    std::vector<FieldPlace> places;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0, 1);
    for (int i = 0; i < 20000; ++i) {
        const Vec3f at(unit(random), 0, unit(random));
        places.push_back({at, normal, lightOf(1, found(at.x))});
    }
    return places;
}

TEST(CorrectionField, FollowsWhatWasFoundAndTellsSidesApart) {
    std::vector<FieldPlace> places =
        square({0, 1, 0}, [](float x) { return x < 0.5f ? 2.0f : 4.0f; });
    for (const FieldPlace& below : square({0, -1, 0}, [](float) { return 0.5f; }))
        places.push_back(below);
    const CorrectionField field(places, 0.05f);
    EXPECT_NEAR(field.at({0.2f, 0, 0.5f}, {0, 1, 0}).direct.found.x, 2, 0.05);
    EXPECT_NEAR(field.at({0.8f, 0, 0.5f}, {0, 1, 0}).direct.found.x, 4, 0.05);
    EXPECT_NEAR(field.at({0.8f, 0, 0.5f}, {0, -1, 0}).direct.found.x, 0.5, 0.05);
    EXPECT_NEAR(field.at({0.5f, 0, 0.5f}, {0, 1, 0}).direct.found.x, 3, 0.2);
    EXPECT_NEAR(field.at({0.3f, 0, 0.5f}, {0, 1, 0}).indirect.found.x, 2, 1e-4);
}

TEST(CorrectionField, IsTheMeanFarFromAllPlaces) {
    const CorrectionField field(square({0, 1, 0}, [](float x) { return 2 * x; }), 0.05f);
    for (const Vec3f& far : {Vec3f(50, 0, 0), Vec3f(-1e30f, 1e30f, 0)}) {
        EXPECT_NEAR(field.at(far, {0, 1, 0}).direct.found.x, 1, 0.02);
        EXPECT_NEAR(field.at(far, {1, 0, 0}).direct.predicted.x, 1, 1e-4);
    }
    EXPECT_EQ(CorrectionField({}, 1).at({0, 0, 0}, {0, 1, 0}).direct.found, Rgb(0));
}

TEST(CheckedLight, AddsWhatIsMissingAndScalesWhatIsTooMuch) {
    EXPECT_EQ((CheckedLight{Rgb(1), Rgb(3)}).correct(Rgb(0.5f)), Rgb(2.5f));
    EXPECT_EQ((CheckedLight{Rgb(2), Rgb(1)}).correct(Rgb(0.5f)), Rgb(0.25f));
    EXPECT_EQ((CheckedLight{Rgb(2), Rgb(-1)}).correct(Rgb(0.5f)), Rgb(0));
    EXPECT_EQ((CheckedLight{Rgb(0), Rgb(0)}).correct(Rgb(0.5f)), Rgb(0.5f));
}

/// A floor under a slab, and a sky whose light lies where the slab's rim leaves part of a region.
class PreviewCorrection : public testing::Test {
protected:
    PreviewCorrection() : world_(test::slabMesh(), test::noiseMap(64, 32, 5), {.spacing = 4}) {}

    Film render(int samples, bool planned = true) const {
        const LightGroups groups({}, world_.mesh, nullptr);
        EstimatorContext context = world_.context();
        context.groups = &groups;
        const auto estimator = findEstimator("cache").make(context);
        RenderOptions options;
        options.width = 64;
        options.height = 40;
        options.cameraRays = 4;
        options.samples = samples;
        options.crop = crop_;
        FrameRequest frame{*estimator, lookAt({-1.8, 1.1, 2.8}, {0, 0.3, 0}, {0, 1, 0}, 0.8), 1,
                           options};
        RenderStats stats;
        if (planned) frame.plan = planFrame(frame, stats);
        return shadowcache::render(frame, stats);
    }

    static double mean(const Film& film, Rgb Pixel::*part) {
        double sum = 0;
        for (const Pixel& pixel : film.pixels)
            if (pixel.coverage > 0) sum += static_cast<double>((pixel.*part).y);
        return sum;
    }

    const test::World world_;
    std::optional<FilmRectangle> crop_;
};

TEST_F(PreviewCorrection, HasTheMeanOfThePicture) {
    const Film reference = render(256), corrected = render(0), predicted = render(0, false);
    for (Rgb Pixel::*part : {&Pixel::irradiance, &Pixel::diffuse}) {
        const double truth = mean(reference, part);
        EXPECT_NEAR(mean(corrected, part) / truth, 1, 0.02);
        EXPECT_GT(std::abs(mean(predicted, part) / truth - 1), 0.03) << "control";
    }
    const auto error = [&](const Film& film) {
        double sum = 0;
        for (std::size_t i = 0; i < film.pixels.size(); ++i)
            if (film.pixels[i].coverage > 0)
                sum += static_cast<double>(
                    std::abs(film.pixels[i].irradiance.y - reference.pixels[i].irradiance.y));
        return sum;
    };
    EXPECT_LT(error(corrected), 0.7 * error(predicted));
    for (std::size_t i = 0; i < corrected.pixels.size(); ++i) {
        const Pixel& pixel = corrected.pixels[i];
        EXPECT_GE(pixel.diffuse.y, 0);
        Rgb sum(0, 0, 0);
        for (const Rgb& ofGroup : corrected.groupColors[i]) sum += ofGroup;
        EXPECT_NEAR(sum.y, pixel.color.y, 1e-5f * (1 + pixel.color.y));
    }
}

TEST_F(PreviewCorrection, LeavesTheSkyAloneAndCropsShowWhatTheWholeShows) {
    const Film whole = render(0), predicted = render(0, false);
    int sky = 0, changed = 0;
    for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
        const bool same = whole.pixels[i].color == predicted.pixels[i].color;
        if (whole.pixels[i].coverage > 0)
            changed += same ? 0 : 1;
        else
            EXPECT_TRUE(same) << ++sky;
        sky += whole.pixels[i].coverage > 0 ? 0 : 1;
    }
    EXPECT_GT(sky, 100);
    EXPECT_GT(changed, 1000);
    crop_ = FilmRectangle{20, 12, 13, 9};
    const Film part = render(0);
    for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x)
            EXPECT_EQ(
                part.pixels[static_cast<std::size_t>(y * part.width + x)].color,
                whole.pixels[static_cast<std::size_t>((y + 12) * whole.width + x + 20)].color);
}

}  // namespace
}  // namespace shadowcache
