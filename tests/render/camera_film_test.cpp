// What lens, shutter, planes and a transparent sky make of a picture: an edge 2 m away, left of the
// view's middle, of a plate that reflects half of a constant sky.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "render/frame/aov_channels.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "render/table/estimator_table.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

class CameraFilm : public testing::Test {
protected:
    static constexpr int kWidth = 24, kHeight = 16;
    static constexpr double kAway = 2, kHalfWidth = 1.5;  ///< of the view, where the plate is

    CameraFilm() {
        camera_.fovY = 2 * std::atan(kHalfWidth / kAway * kHeight / kWidth);
        options_.width = kWidth;
        options_.height = kHeight;
        options_.cameraRays = 64;
        options_.samples = 1;
        options_.filter = FilterKind::box;
        options_.transparent = true;
    }

    static TriangleMesh plate() {
        TriangleMesh mesh;
        const auto z = static_cast<float>(-kAway);
        test::addQuad(mesh, {-9, -9, z}, {0, -9, z}, {0, 9, z}, {-9, 9, z});
        return mesh;
    }

    Film film(const CameraMove& camera) const {
        RenderStats stats;
        FrameRequest frame{*mis_, camera, 1, options_};
        frame.plan = planFrame(frame, stats);
        return render(frame, stats);
    }

    /// Most difference between a column's coverage and what it is by `share`, the share of the rays
    /// that meet the plate which aim at a place so far right of its edge.
    double mostOff(const Film& film, const std::function<double(double)>& share) const {
        constexpr int kSteps = 64;
        double most = 0;
        for (int x = 0; x < kWidth; ++x) {
            double found = 0, wanted = 0;
            for (int y = 0; y < kHeight; ++y)
                found += static_cast<double>(
                             film.pixels[static_cast<std::size_t>(y * kWidth + x)].coverage) /
                         kHeight;
            for (int i = 0; i < kSteps; ++i)
                wanted += share(((x + (i + 0.5) / kSteps) / kWidth * 2 - 1) * kHalfWidth) / kSteps;
            most = std::max(most, std::abs(found - wanted));
        }
        return most;
    }

    static double sharp(double right) { return right < 0 ? 1 : 0; }

    Camera camera_;
    RenderOptions options_;
    TriangleMesh mesh_ = plate();
    Scene scene_{mesh_};
    Environment environment_ = test::environmentOf(test::constantMap(Rgb(1, 1, 1)));
    std::unique_ptr<Estimator> mis_ = findEstimator("mis").make({scene_, environment_, nullptr});
};

/// Coverage has an error of about 1 / rays of a column.
constexpr double kClose = 0.01;

TEST_F(CameraFilm, WithoutALensEdgesAreSharp) {
    EXPECT_LT(mostOff(film(camera_), sharp), kClose);
}

TEST_F(CameraFilm, LensBlursByTheFormulaOfTheThinLens) {
    camera_.lens = {.radius = 0.3, .focus = 2 * kAway};
    // A ray from x on the lens to a place s of the plane that is sharp passes the plate at
    // (x + s) / 2, and the film's place is that of s / 2.
    const auto share = [&](double right) {
        const double x = std::clamp(-2 * right / camera_.lens.radius, -1.0, 1.0);
        return 0.5 + (x * std::sqrt(1 - x * x) + std::asin(x)) / std::numbers::pi;
    };
    const Film blurred = film(camera_);
    EXPECT_LT(mostOff(blurred, share), kClose);
    EXPECT_GT(mostOff(blurred, sharp), 10 * kClose);
    camera_.lens.focus = kAway;
    EXPECT_LT(mostOff(film(camera_), sharp), kClose);
}

TEST_F(CameraFilm, ShutterBlursByTheWayOfTheCamera) {
    Camera left = camera_, right = camera_;
    left.origin.x = -0.4;
    right.origin.x = 0.4;
    const Film blurred = film(CameraMove(left, right));
    const auto share = [](double x) { return std::clamp(0.5 - x / 0.8, 0.0, 1.0); };
    EXPECT_LT(mostOff(blurred, share), kClose);
    EXPECT_GT(mostOff(blurred, sharp), 10 * kClose);
}

TEST_F(CameraFilm, ShiftMovesTheEdge) {
    camera_.shiftX = 0.25;
    EXPECT_LT(mostOff(film(camera_), [](double x) { return sharp(x + kHalfWidth / 2); }), kClose);
}

TEST_F(CameraFilm, PlanesCutThePlateOff) {
    for (const bool lens : {false, true}) {
        camera_ = {.fovY = camera_.fovY};
        if (lens) camera_.lens = {.radius = 0.01, .focus = kAway};
        camera_.near = 0.99 * kAway;
        camera_.far = 1.01 * kAway;
        const Pixel seen = film(camera_).pixels.front();
        EXPECT_EQ(seen.coverage, 1);
        EXPECT_NEAR(seen.axialDepth, kAway, 1e-4);
        EXPECT_NEAR(seen.depth, std::hypot(kAway, kHalfWidth, kHalfWidth * kHeight / kWidth), 0.1);
        camera_.near = 1.01 * kAway;
        camera_.far = 9;
        EXPECT_EQ(film(camera_).pixels.front().coverage, 0);
        camera_.near = 0;
        camera_.far = 0.99 * kAway;
        EXPECT_EQ(film(camera_).pixels.front().coverage, 0);
    }
}

TEST_F(CameraFilm, TransparentIsTheOpaqueOneWithoutItsSky) {
    const Film clear = film(camera_);
    options_.transparent = false;
    const Film opaque = film(camera_);
    EXPECT_TRUE(alphaOf(opaque).empty());
    EXPECT_EQ(channels(opaque, {}).size(), 3u);
    const std::vector<Channel> found = channels(clear, {});
    ASSERT_EQ(found.size(), 4u);
    EXPECT_EQ(found[3].name, "A");
    for (std::size_t i = 0; i < clear.pixels.size(); ++i) {
        const float alpha = clear.pixels[i].coverage;
        EXPECT_EQ(found[3].values[i], alpha);
        EXPECT_EQ(alphaOf(clear)[i], alpha);
        const Rgb behind = clear.pixels[i].color + Rgb(1 - alpha);
        EXPECT_NEAR(behind.x, opaque.pixels[i].color.x, 1e-5) << i;
    }
}

}  // namespace
}  // namespace shadowcache
