// Emitters thinner than a pixel are found, with what they cover of pixels, but not where they are
// hidden; pixels that show them get more camera rays, which lowers their noise and changes no mean.

#include "render/frame/visible_emitters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr float kTubeRadiance = 50;
constexpr double kTubeWidth = 0.002, kTubeHeight = 1.2;  // of the tube

/// A lamp that cameras see in place of the tube's two triangles.
void makeLamp(TriangleMesh& mesh) {
    mesh.triangles.resize(mesh.triangles.size() - 2);
    mesh.parts.pop_back();
    Lamp lamp;
    lamp.form = Lamp::Form::rectangle;
    lamp.strength = Rgb(static_cast<float>(kTubeWidth * kTubeHeight) * kTubeRadiance);
    lamp.position = Vec3d(0, 0.3 + kTubeHeight / 2, -1);
    lamp.direction = Vec3d(0, 0, 1);
    lamp.halfWidth = Vec3d(kTubeWidth / 2, 0, 0);
    lamp.halfHeight = Vec3d(0, kTubeHeight / 2, 0);
    lamp.seenByCamera = true;
    mesh.lamps = {lamp};
}

/// What the tube is.
enum class Tube { surface, hidden, lamp };

/// A tube before a wall, by which it lights the floor; a panel may hide it.
TriangleMesh tubeMesh(Tube tube) {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addQuad(mesh, {-2, 0, -2}, {2, 0, -2}, {2, 2, -2}, {-2, 2, -2});
    if (tube == Tube::hidden) test::addBox(mesh, {-0.1f, 0.1f, -0.8f}, {0.1f, 1.9f, -0.75f});
    const auto first = static_cast<std::uint32_t>(mesh.triangles.size());
    const auto half = static_cast<float>(kTubeWidth / 2),
               high = static_cast<float>(0.3 + kTubeHeight);
    test::addQuad(mesh, {-half, 0.3f, -1}, {half, 0.3f, -1}, {half, high, -1}, {-half, high, -1});
    Material plain, lamp;
    plain.albedo = Rgb(0.6f);
    lamp.albedo = Rgb(0.0f);
    lamp.finish.emission = Rgb(kTubeRadiance);
    mesh.materials = {plain, lamp};
    mesh.parts = {{0, first, 0}, {first, 2, 1}};
    if (tube == Tube::lamp) makeLamp(mesh);
    return mesh;
}

/// A frame of the tube under a dark sky.
class TubeFrame {
public:
    explicit TubeFrame(Tube tube)
        : world_(tubeMesh(tube), test::constantMap(Rgb(0.0f)), {.spacing = 0.25}),
          estimator_(findEstimator("cache").make(world_.context(), {})),
          request_{*estimator_, lookAt({0, 1, 2}, {0, 0.9, -1}, {0, 1, 0}, 0.9), 1, {}} {
        request_.options.width = 33;  // the tube is within the middle column
        request_.options.height = 24;
        request_.options.cameraRays = 8;
        request_.options.samples = 2;
        request_.options.filter = FilterKind::box;
        request_.options.seed = 1000;
        RenderStats stats;
        request_.plan = planFrame(request_, stats);
    }

    const FrameRequest& request() const { return request_; }
    FrameRequest& request() { return request_; }

private:
    test::World world_;
    std::unique_ptr<Estimator> estimator_;
    FrameRequest request_;
};

/// Luminance and its square, summed over the pixels, and how many pixels have any.
struct Sums {
    double luminance = 0, square = 0;
    int pixels = 0;
};

Sums sumsOf(const TubeFrame& frame) {
    const VisibleEmitters emitters(frame.request());
    Sums sums;
    for (int y = 0; y < frame.request().options.height; ++y)
        for (int x = 0; x < frame.request().options.width; ++x) {
            PredictedSpread spread{.count = 1};
            emitters.addTo({x, y}, spread);
            sums.luminance += spread.emitted.sum;
            sums.square += spread.emitted.squares;
            sums.pixels += spread.emitted.sum > 0 ? 1 : 0;
        }
    return sums;
}

TEST(VisibleEmitters, AreFoundWhereTheyAreThinnerThanAPixel) {
    // Three from the camera, but for the tilt of the view, which foreshortens all by less than .1
    // %.
    const double pixel = 2 * 3 * std::tan(0.45) / 24;
    const double area = kTubeWidth / pixel * kTubeHeight / pixel;
    for (const Tube tube : {Tube::surface, Tube::lamp}) {
        const Sums seen = sumsOf(TubeFrame(tube));
        EXPECT_NEAR(seen.luminance, area * static_cast<double>(kTubeRadiance),
                    0.03 * seen.luminance);
        EXPECT_NEAR(seen.square, seen.luminance * static_cast<double>(kTubeRadiance),
                    1e-3 * seen.square);
        EXPECT_NEAR(seen.pixels, kTubeHeight / pixel, 2);
    }
    // Control: behind a panel there is nothing to see.
    EXPECT_EQ(sumsOf(TubeFrame(Tube::hidden)).pixels, 0);
}

TEST(VisibleEmitters, GetCameraRaysThatLowerTheirNoise) {
    TubeFrame frame(Tube::surface);
    FrameRequest& request = frame.request();
    ASSERT_TRUE(request.plan.antialiasing);
    const auto sums = [&] {
        test::Estimates found;
        RenderStats stats;
        for (request.options.seed = 1; request.options.seed <= 100; ++request.options.seed) {
            double sum = 0;
            for (const Pixel& pixel : render(request, stats).pixels)
                sum += static_cast<double>(pixel.color.y);
            found.color[1].push_back(sum);
        }
        return found;
    };
    const test::Estimates with = sums();
    request.plan.visibleEmitters = nullptr;
    const test::Estimates without = sums();
    const double level = test::significance(1);
    EXPECT_GT(test::sameMeanPValue(with.color[1], without.color[1]), level);
    // Control: twice the mean.
    std::vector<double> off = with.color[1];
    for (double& sum : off) sum *= 2;
    EXPECT_LT(test::sameMeanPValue(off, without.color[1]), level);
    EXPECT_LT(with.sampleVariance(1), 0.4 * without.sampleVariance(1));
}

}  // namespace
}  // namespace shadowcache
