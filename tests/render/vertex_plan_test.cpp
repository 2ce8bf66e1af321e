// Vertices of paths have a plan of their own: what is right where the camera looks is not right
// where its light comes from.

#include <gtest/gtest.h>

#include <cmath>

#include "common/shot/view.h"
#include "render/frame/integrator.h"
#include "render/frame/pilot.h"
#include "render/table/estimator_table.h"
#include "tests/support/solved.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

/// Two walls and a roof over a floor.
TriangleMesh corner() {
    TriangleMesh mesh;
    test::addFloor(mesh, 0, -2, 2, -2, 2);
    test::addFloor(mesh, 2, -2, 1, -2, 1);
    test::addQuad(mesh, {-2, 0, -2}, {-2, 2, -2}, {-2, 2, 2}, {-2, 0, 2});
    test::addQuad(mesh, {-2, 0, -2}, {2, 0, -2}, {2, 2, -2}, {-2, 2, -2});
    return mesh;
}

/// Shadow rays of a vertex, on the mean over those of a film.
double raysOfVertex(const FrameRequest& frame) {
    RenderStats stats;
    render(frame, stats);
    return static_cast<double>(stats.bounces.shadowRays) /
           static_cast<double>(stats.bounces.vertices);
}

// The control is the plan of what the camera sees: no place has less than a quarter of its samples.
TEST(VertexPlan, SharesOutTheSamplesOfVertices) {
    const test::World world(corner(), test::noiseMap(16, 8, 3));
    const test::Solved solved(world.scene, world.environment, world.cache.cache(), PlainLook{}, 4);
    EstimatorContext context = world.context();
    context.solve = &solved.solve;
    context.radiosity = &solved.radiosity;
    const auto estimator = findEstimator("cache").make(context, {});
    RenderOptions options;
    options.width = 24;
    options.height = 16;
    options.bounces = 4;
    for (const int samples : {1, 16, 64}) {
        options.samples = samples;
        options.cameraRays = 64 / samples;
        const Camera camera = lookAt({1.5, 1.5, 1.5}, {-1, 0.5, -1}, {0, 1, 0}, 1.1);
        FrameRequest frame{*estimator, camera, 1, options};
        RenderStats stats;
        frame.plan = planFrame(frame, stats);
        const double wanted = std::sqrt(samples);
        const double planned = raysOfVertex(frame);
        frame.plan.vertices = frame.plan.estimator;
        const double seen = raysOfVertex(frame);
        EXPECT_GT(planned, 0.5 * wanted) << samples;
        EXPECT_LT(planned, 1.7 * wanted) << samples;
        if (samples == 64) {
            EXPECT_GT(seen, 1.5 * wanted);
        }
    }
}

}  // namespace
}  // namespace shadowcache
