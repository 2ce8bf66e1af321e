// What moves is in no cache, and the estimates are right all the same.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/import/mesh_options.h"
#include "common/shot/moving_set.h"
#include "render/table/estimator_table.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

constexpr double kSpacing = 0.25;

std::string slabObj() {
    return "v -0.5 0 -0.5\nv 0.5 0 -0.5\nv 0.5 0 0.5\nv -0.5 0 0.5\nf 1 2 3 4\n";
}

/// A floor with a wall, baked, and a slab that hovers over it in frame 2 only.
class Moving : public testing::Test {
protected:
    Moving() {
        test::addFloor(mesh_, 0, -2, 2, -2, 2);
        test::addBox(mesh_, {-2, 0, -2}, {2, 1, -1.8f});
        scene_.emplace(mesh_);
        BakeOptions options;
        options.spacing = kSpacing;
        cache_.emplace(bake(*scene_, options));
        DynamicFile slab = parseDynamic(folder_.write("slab.obj", slabObj()).string() + "@" +
                                        (folder_.path() / "track.json").string());
        folder_.write("track.json",
                      R"({"frames": [{"translation": [0, 50, 0]},
                          {"translation": [0.2, 0.6, 0.1], "scale": [1.2, 1, 1]}]})");
        objects_ = openDynamic(std::span(&slab, 1), {}, 24);
        moving_.emplace(std::span<const GltfShot>(), objects_, MeshOptions(), mesh_.origin);
    }

    ShadingPoint floorPoint(float x, float z) const {
        return test::pointAlong(*scene_, {x, 0.3f, z}, {0, -1, 0});
    }

    test::TemporaryFolder folder_;
    TriangleMesh mesh_;
    std::optional<Scene> scene_;
    std::optional<test::TestCache> cache_;
    std::vector<DynamicObject> objects_;
    std::optional<MovingSet> moving_;
};

TEST_F(Moving, IsSeenAndCastsShadowsWhereItIs) {
    const Vec3f up(0, 1, 0);
    RayPacket packet{};
    packet.set(0, {0.2f, 0.1f, 0.1f}, up);
    const auto reachesSky = [this] {
        RayStream stream{};
        for (int k = 0; k < 3; ++k) {
            stream.origin[k][0] = k == 0 ? 0.2f : 0.1f;
            stream.direction[k][0] = k == 1 ? 1.0f : 0.0f;
        }
        stream.reach[0] = std::numeric_limits<float>::infinity();
        scene_->trace(stream, 1);
        return stream.reach[0] >= 0;
    };
    for (const int frame : {1, 2, 1}) {
        scene_->setMoving(moving_->pose(frame));
        const Hit hit = scene_->intersect({0.2f, 0.1f, 0.1f}, up);
        ASSERT_TRUE(hit.found);
        EXPECT_NE(hit.scene, &*scene_);
        EXPECT_NEAR(hit.position.y, frame == 1 ? 50 : 0.6, 1e-4);
        EXPECT_EQ(scene_->visibility(packet, 1), 0u);
        EXPECT_FALSE(reachesSky());
        float distance = 0;
        scene_->distances(packet, 1, &distance);
        EXPECT_NEAR(distance, frame == 1 ? 49.9 : 0.5, 1e-4);
    }
    // The set's own looks are found whatever stands on it.
    RayPacket down{};
    down.set(0, {0.2f, 3, 0.1f}, {0, -1, 0});
    scene_->setMoving(moving_->pose(2));
    Hit still, met;
    scene_->meetStill(down, 1, &still);
    scene_->meet(down, 1, &met);
    EXPECT_EQ(still.scene, &*scene_);
    EXPECT_NE(met.scene, &*scene_);
    scene_->setMoving(nullptr);
    EXPECT_EQ(scene_->visibility(packet, 1), 1u);
    EXPECT_TRUE(reachesSky());
    test::expectError([&] { moving_->requireFrame(3); }, "track.json", "frame 3, expected 1 to 2");
}

// With its control: the truth without the slab must be rejected.
TEST_F(Moving, ChangesNoMean) {
    const Image map = test::noiseMap(16, 8, 3);
    const Environment environment = test::environmentOf(map);
    const EstimatorContext context{*scene_, environment, &cache_->cache(), {}};
    const auto estimator = findEstimator("cache").make(context);
    std::vector<ShadingPoint> points{floorPoint(0.1f, 0.2f), floorPoint(1.2f, 0.9f)};
    std::vector<Rgb> without;
    without.reserve(points.size());
    for (const ShadingPoint& point : points)
        without.push_back(test::tracedIrradiance(*scene_, point, map, 64));
    scene_->setMoving(moving_->pose(2));
    // And a place on the slab's upper side, of which the cache knows nothing.
    const Hit hit = scene_->intersect({0.2f, 3, 0.1f}, {0, -1, 0});
    ASSERT_NE(hit.scene, &*scene_);
    points.push_back({{hit.scene->rayOrigin(hit.position, hit.triangle, {0, 1, 0}),
                       mesh_.origin + Vec3d(hit.position),
                       {0, 1, 0},
                       {0, 1, 0}},
                      {}});
    const double level = test::significance(2 * points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Rgb truth = test::tracedIrradiance(*scene_, points[i], map, 64);
        for (const int samples : {4, 64}) {
            const auto estimates = test::runEstimator(*estimator, points[i], samples, 1000);
            EXPECT_GT(test::agreementPValue(estimates, truth), level)
                << i << ", " << samples << ": mean " << estimates.mean(1) << ", wanted " << truth.y;
            const Rgb wrong = i < without.size() ? without[i] : truth * 1.1f;
            if (samples == 64) {
                EXPECT_LT(test::agreementPValue(estimates, wrong), level) << i;
            }
        }
    }
}

/// The noise where moving objects make the counts uncertain: trusted counts would give the rare
/// samples in a shadow great weights.
TEST_F(Moving, CostsNoMoreThanTheMapAlone) {
    const Image map = test::oneTexelMap(64, 32, 16, 4, Rgb(500));
    const Environment environment = test::environmentOf(map);
    const EstimatorContext context{*scene_, environment, &cache_->cache(), {}};
    const auto cached = findEstimator("cache").make(context);
    const auto plain = findEstimator("mis").make(context);
    scene_->setMoving(moving_->pose(2));
    double withCache = 0, without = 0;
    for (const float x : {-0.6f, -0.2f, 0.2f, 0.6f, 1.0f})
        for (const float z : {-0.6f, 0.0f, 0.6f}) {
            const ShadingPoint point = floorPoint(x, z);
            withCache += test::runEstimator(*cached, point, 16, 300).sampleVariance(1);
            without += test::runEstimator(*plain, point, 16, 300).sampleVariance(1);
        }
    EXPECT_LT(withCache, without);
}

TEST(MovingTracks, AreReadOrRefused) {
    const test::TemporaryFolder folder;
    const auto refuses = [&](const std::string& text, const std::string& cause) {
        const auto path = folder.write("t.json", text);
        test::expectError([&] { readTransformTrack(path); }, "t.json", cause);
    };
    refuses("{", "is not JSON");
    refuses("[]", "has no list of frames");
    refuses(R"({"frames": []})", "has no list of frames");
    refuses(R"({"frames": [{"scale": [1, 2]}]})",
            "frames[0].scale is [1,2], expected a list of 3 finite numbers");
    refuses(R"({"frames": [{"rotation": [1, 2, 3, "x"]}]})",
            "frames[0].rotation is [1,2,3,\"x\"], expected a list of 4");
    refuses(R"({"frames": [{}, {"rotation": [0, 0, 0, 0.0]}]})",
            "frames[1].rotation is [0,0,0,0.0], expected a quaternion that is not 0");
    refuses(R"({"fps": 12, "frames": [{}]})", "unknown key fps");
    refuses(R"({"frames": [{}, {"position": [0, 1, 0]}]})", "unknown key frames[1].position");
    refuses(R"({"frames": [)" + std::string(1000, '[') + "]}", "nested deeper");
    EXPECT_EQ(parseDynamic("a@b.obj").mesh, "a@b.obj");
    EXPECT_EQ(parseDynamic("a@b.obj@c.json").track, "c.json");
}

}  // namespace
}  // namespace shadowcache
