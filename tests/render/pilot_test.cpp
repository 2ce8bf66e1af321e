// Where a frame's pilot looks. Part of film_test.

#include "render/frame/pilot.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "render/frame/integrator.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

/// Keeps what its pilot is shown.
class Looker final : public PointEstimator, public FramePilot {
public:
    using PointEstimator::PointEstimator;
    const FramePilot* pilot() const override { return this; }

    mutable std::vector<ShadingPoint> seen;

private:
    std::size_t places(std::uint64_t) const override { return 1024; }
    std::unique_ptr<const EstimatorPlan> plan(std::span<const ShadingPoint> points, int,
                                              double) const override {
        seen.assign(points.begin(), points.end());
        return std::make_unique<EstimatorPlan>();
    }
    Rgb prepare(const ShadingPoint&, const SampleSlice&, Workspace&) const override {
        return Rgb(0, 0, 0);
    }
};

TEST(Pilot, LooksEvenlyOverTheFilm) {
    const TriangleMesh mesh = test::floorMesh();
    const Scene scene(mesh);
    const Environment environment = test::environmentOf(test::noiseMap(64, 32, 5));
    const Looker looker({scene, environment, nullptr});
    RenderOptions options;
    options.width = options.height = 32;
    FrameRequest frame{looker, lookAt({0, 0.1, 0.05}, {0, 0, 0}, {0, 0, 1}, 0.9), 1, options};
    RenderStats stats;
    // As many places as pixels: one in each.
    const auto pixels = [&](std::uint64_t seed) {
        frame.options.seed = seed;
        frame.plan = planFrame(frame, stats);
        std::vector<int> visits(1024);
        for (const ShadingPoint& point : looker.seen)
            ++visits[static_cast<std::size_t>(point.slot.filmY * 32 + point.slot.filmX)];
        return visits;
    };
    EXPECT_EQ(pixels(1), std::vector<int>(1024, 1));
    const std::vector<ShadingPoint> first = looker.seen;
    EXPECT_EQ(pixels(2), std::vector<int>(1024, 1));
    // Control: other seeds look at other places of these pixels.
    int same = 0;
    for (std::size_t i = 0; i < first.size(); ++i)
        same += first[i].place.position == looker.seen[i].place.position;
    EXPECT_LT(same, 10);
}

}  // namespace
}  // namespace shadowcache
