// Lamps of KHR_lights_punctual: units, places, what makes them soft, where they move to; what is
// refused, and what is named.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "common/import/load_mesh.h"
#include "common/shot/moving_lamps.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

using Json = nlohmann::json;
using test::GltfBuilder;

/// A square, and a node with a light.
GltfBuilder setWith(const Json& light, Json node = Json::object()) {
    GltfBuilder file = test::squareGltf();
    file.root({{"mesh", 0}});
    file.json["extensionsUsed"] = {"KHR_lights_punctual"};
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {light};
    node["extensions"]["KHR_lights_punctual"]["light"] = 0;
    file.root(node);
    return file;
}

TriangleMesh loaded(const GltfBuilder& file, MeshOptions options = {}) {
    const test::TemporaryFolder folder;
    const auto path = folder.write("a.glb", file.glb());
    options.origin = Vec3d(0, 0, 0);
    return loadMesh({&path, 1}, options);
}

Lamp lampOf(const Json& light, const Json& node = Json::object(), const MeshOptions& options = {}) {
    const TriangleMesh mesh = loaded(setWith(light, node), options);
    EXPECT_EQ(mesh.lamps.size(), 1u);
    EXPECT_TRUE(mesh.report.leftOutOf.empty()) << describe(mesh.report);
    return mesh.lamps.empty() ? Lamp() : mesh.lamps[0];
}

TEST(GltfLamps, AreReadWithTheirDefaults) {
    const Lamp point = lampOf({{"type", "point"}, {"name", "bulb"}});
    EXPECT_EQ(point.name, "bulb");
    EXPECT_EQ(point.form, Lamp::Form::point);
    EXPECT_EQ(point.strength, Rgb(1, 1, 1));
    EXPECT_EQ(point.radius, 0);
    EXPECT_FALSE(point.cone);
    EXPECT_FALSE(point.seenByCamera);
    EXPECT_TRUE(lampOf({{"type", "point"}, {"extras", {{"camera", true}}}}).seenByCamera);
    const Lamp spot = lampOf({{"type", "spot"}});
    ASSERT_TRUE(spot.cone);
    EXPECT_DOUBLE_EQ(spot.cone->cosInner, 1);
    EXPECT_DOUBLE_EQ(spot.cone->cosOuter, std::cos(kPi / 4));
    EXPECT_FALSE(spot.cone->smooth);
    EXPECT_EQ(lampOf({{"type", "directional"}}).form, Lamp::Form::sun);
}

TEST(GltfLamps, AreWhereTheirNodesAre) {
    // A quarter turn about +X: -Z becomes +Y.
    const double half = std::sqrt(0.5);
    const Lamp spot = lampOf({{"type", "spot"},
                              {"color", {1, 0.5, 0}},
                              {"intensity", 8},
                              {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.3}}},
                              {"extras", {{"radius", 0.2}, {"falloff", "smoothstep"}}}},
                             {{"name", "desk"},
                              {"translation", {1, 2, 3}},
                              {"rotation", {half, 0, 0, half}},
                              {"scale", {2, 2, 2}}});
    EXPECT_EQ(spot.name, "desk");
    EXPECT_EQ(spot.strength, Rgb(8, 4, 0));
    EXPECT_LT((spot.position - Vec3d(1, 2, 3)).length(), 1e-12);
    EXPECT_LT((spot.direction - Vec3d(0, 1, 0)).length(), 1e-12);
    EXPECT_EQ(spot.radius, 0.2);
    EXPECT_DOUBLE_EQ(spot.cone->cosInner, std::cos(0.1));
    EXPECT_TRUE(spot.cone->smooth);
}

TEST(GltfLamps, HaveAreasThatTheirNodesScale) {
    const Lamp area = lampOf(
        {{"type", "spot"}, {"intensity", 3}, {"extras", {{"shape", "ellipse"}, {"size", {1, 2}}}}},
        {{"scale", {2, 3, 1}}});
    EXPECT_EQ(area.form, Lamp::Form::ellipse);
    EXPECT_FALSE(area.cone);
    EXPECT_LT((area.halfWidth - Vec3d(1, 0, 0)).length(), 1e-12);
    EXPECT_LT((area.halfHeight - Vec3d(0, 3, 0)).length(), 1e-12);
    EXPECT_LT((area.direction - Vec3d(0, 0, -1)).length(), 1e-12);
    EXPECT_EQ(area.strength, Rgb(3, 3, 3));
    EXPECT_EQ(area.spread, kPi);
    EXPECT_EQ(lampOf({{"type", "spot"},
                      {"extras", {{"shape", "rectangle"}, {"size", {1, 2}}, {"spread", 0.5}}}})
                  .spread,
              0.5);
}

TEST(GltfLamps, LookTheSameInAnotherUnit) {
    const Json point{{"type", "point"}, {"intensity", 5}, {"extras", {{"radius", 0.5}}}};
    const Lamp lamp = lampOf(point, {{"translation", {1, 2, 3}}}, {.zUp = true, .scale = 10});
    EXPECT_EQ(lamp.strength, Rgb(500, 500, 500));
    EXPECT_EQ(lamp.radius, 5);
    EXPECT_LT((lamp.position - Vec3d(10, 30, -20)).length(), 1e-9);
    const Lamp sun =
        lampOf({{"type", "directional"}, {"intensity", 5}, {"extras", {{"angle", 0.1}}}},
               Json::object(), {.scale = 10});
    EXPECT_EQ(sun.strength, Rgb(5, 5, 5));
    EXPECT_EQ(sun.angle, 0.1);
}

Json areaOfSpread(const Json& spread) {
    return {{"type", "spot"},
            {"extras", {{"shape", "rectangle"}, {"size", {1, 1}}, {"spread", spread}}}};
}

TEST(GltfLamps, OfBadNumbersAreRefused) {
    const std::pair<Json, const char*> cases[] = {
        {{{"type", "point"}, {"intensity", -1}}, "intensity -1"},
        {{{"type", "point"}, {"intensity", 1e300}}, "intensity 1e+300"},
        {{{"type", "point"}, {"color", {1, -2, 1}}}, "color"},
        {{{"type", "lantern"}}, "type"},
        {{{"name", "x"}}, "no type"},
        {{{"type", "spot"}, {"spot", {{"innerConeAngle", 0.4}, {"outerConeAngle", 0.3}}}},
         "innerConeAngle"},
        {{{"type", "spot"}, {"spot", {{"outerConeAngle", 2}}}}, "outerConeAngle"},
        {{{"type", "point"}, {"extras", {{"radius", -1}}}}, "radius"},
        {{{"type", "point"}, {"extras", {{"camera", 1}}}}, "camera"},
        {{{"type", "spot"}, {"extras", {{"shape", "rectangle"}, {"size", {0, 1}}}}}, "size"},
        {{{"type", "spot"}, {"extras", {{"shape", "star"}}}}, "shape"},
        {areaOfSpread(0), "spread 0, expected 0.01 to 3.142"},
        {areaOfSpread(-1), "spread -1, expected 0.01 to 3.142"},
        {areaOfSpread(3.2), "spread 3.2, expected 0.01 to 3.142"},
        {areaOfSpread("wide"), "spread"}};
    for (const auto& badLight : cases)
        test::expectError([&] { loaded(setWith(badLight.first)); }, "light 0", badLight.second);
}

TEST(GltfLamps, ThatAreNotReadAreNamed) {
    EXPECT_EQ(loaded(setWith({{"type", "point"}, {"range", 5}})).report.leftOutOf,
              (LeftOutOf{{{"light", "range, a hint, is left out"}, 1}}));
    const Json spot{{"type", "spot"}};
    EXPECT_EQ(loaded(setWith(spot, {{"scale", {1, 1, 0}}})).report.leftOutOf,
              (LeftOutOf{{{"light", "node has no direction, and is left out"}, 1}}));
    EXPECT_EQ(loaded(setWith({{"type", "point"}, {"extras", {{"spread", 1}}}})).report.leftOutOf,
              (LeftOutOf{{{"light", "spread of other than an area is left out"}, 1}}));
}

/// A spot that moves, turns and, from 1 s on, has no size.
GltfBuilder movingSpot() {
    GltfBuilder file = setWith({{"type", "spot"}, {"name", "lantern"}, {"intensity", 2}});
    const float half = std::sqrt(0.5f);
    file.animate(1, "translation", "LINEAR", {0, 1}, {0, 0, 0, 4, 0, 0});
    file.animate(1, "rotation", "STEP", {0, 0.5f}, {0, 0, 0, 1, half, 0, 0, half});
    file.animate(1, "scale", "STEP", {0, 1}, {3, 3, 3, 0, 0, 0});
    return file;
}

TEST(GltfLamps, ThatMoveAreOfTheSetWhereItStandsStill) {
    const GltfBuilder file = movingSpot();
    const TriangleMesh moving = loaded(file);
    EXPECT_TRUE(moving.lamps.empty());
    EXPECT_TRUE(moving.report.leftOutOf.empty()) << describe(moving.report);
    const TriangleMesh still = loaded(file, {.stillAt = 0.5});
    ASSERT_EQ(still.lamps.size(), 1u);
    EXPECT_EQ(still.lamps[0].position, Vec3d(2, 0, 0));
    EXPECT_FALSE(still.lamps[0].moves);
    EXPECT_TRUE(loaded(file, {.stillAt = 1}).lamps.empty());
}

TEST(MovingLamps, AreWhereTheirNodesAre) {
    const test::TemporaryFolder folder;
    const std::filesystem::path path[] = {folder.write("a.glb", movingSpot().glb())};
    const MeshOptions options{.zUp = true, .scale = 2, .gains = {parseLampGain("lan*=3")}};
    std::vector<GltfShot> shots = openShots(path, options, 24);
    ASSERT_EQ(shots[0].movingLampNodes().size(), 1u);
    EXPECT_NE(describe(shots[0]).find("lamp lantern: spot, intensity 2,2,2, moves"),
              std::string::npos);
    shots[0].dropData();
    MovingLamps lamps(shots, {}, options, {1, 0, 0});
    const auto lampAt = [&](int frame) {
        const std::vector<Lamp> found = lamps.at(frame);
        EXPECT_EQ(found.size(), 1u);
        EXPECT_TRUE(found[0].moves);
        return found[0];
    };
    EXPECT_LT((lampAt(6).position - Vec3d(1, 0, 0)).length(), 1e-6);
    EXPECT_LT((lampAt(6).direction - Vec3d(0, -1, 0)).length(), 1e-6);
    EXPECT_LT((lampAt(12).position - Vec3d(3, 0, 0)).length(), 1e-6);
    EXPECT_LT((lampAt(12).direction - Vec3d(0, 0, -1)).length(), 1e-6);
    EXPECT_EQ(lampAt(12).strength, Rgb(8, 8, 8));
    EXPECT_EQ(lampAt(12).gain, Rgb(3, 3, 3));
    EXPECT_EQ(lampAt(24).gain, Rgb(0, 0, 0));
    lamps.setGains({});
    EXPECT_EQ(lampAt(12).gain, Rgb(1, 1, 1));
    EXPECT_EQ(lampAt(24).gain, Rgb(0, 0, 0));
    MeshOptions other = options;
    other.lamps = false;
    EXPECT_TRUE(MovingLamps(shots, {}, other, {0, 0, 0}).at(1).empty());
    other = options;
    other.stillAt = 0;
    EXPECT_TRUE(openShots(path, other, 24)[0].movingLampNodes().empty());
}

// A track is on top of the node's place in the world, and scales areas alone.
TEST(MovingLamps, FollowTheTrackOfTheirFile) {
    const test::TemporaryFolder folder;
    GltfBuilder panel =
        setWith({{"type", "spot"}, {"extras", {{"shape", "rectangle"}, {"size", {1, 2}}}}});
    panel.json["nodes"][1]["translation"] = {1, 2, 3};
    const auto track = folder.write("t.json", R"({"frames": [{"translation": [0, 0, 5]},
        {"rotation": [0, 1, 0, 0], "scale": [2, 2, 2]}, {"scale": [0, 0, 0]},
        {"translation": [1e13, 0, 0]}]})");
    const DynamicFile files[] = {{folder.write("panel.glb", panel.glb()), track},
                                 {folder.write("spot.glb", movingSpot().glb()), {}}};
    const MeshOptions options{.scale = 2};
    const std::vector<DynamicObject> objects = openDynamic(files, options, 24);
    const MovingLamps lamps({}, objects, options, {0, 1, 0});
    const auto lampAt = [&](int frame) {
        const std::vector<Lamp> found = lamps.at(frame);
        EXPECT_EQ(found.size(), 2u);
        EXPECT_TRUE(found[0].moves && found[1].moves);
        return found[0];
    };
    EXPECT_EQ(lampAt(1).position, Vec3d(2, 3, 11));
    EXPECT_LT((lampAt(2).position - Vec3d(-4, 7, -12)).length(), 1e-6);
    EXPECT_LT((lampAt(2).direction + lampAt(1).direction).length(), 1e-6);
    EXPECT_NEAR(lampAt(2).halfWidth.length(), 2 * lampAt(1).halfWidth.length(), 1e-6);
    EXPECT_EQ(lampAt(2).strength, lampAt(1).strength);
    EXPECT_EQ(lampAt(2).gain, Rgb(1, 1, 1));
    EXPECT_EQ(lampAt(3).gain, Rgb(0, 0, 0));
    test::expectError([&] { lamps.at(4); }, "panel.glb", "is not within");
    test::expectError([&] { lamps.at(5); }, "t.json", "frame 5, expected 1 to 4");
    const std::string list = describeMovingLamps(*objects[1].shot);
    EXPECT_NE(list.find("spot.glb:\n  lamp lantern: spot, intensity 2,2,2, moves"),
              std::string::npos)
        << list;
}

// Keys have their times as floats, which frames have not.
TEST(MovingLamps, AreOffInEachFrameThatHidesThem) {
    for (const double fps : {24.0, 25.0, 30.0, 24 / 1.001}) {
        for (const char* interpolation : {"LINEAR", "STEP"}) {
            GltfBuilder file = setWith({{"type", "point"}});
            std::vector<float> times, scales;
            for (int frame = 0; frame <= 120; ++frame) {
                times.push_back(static_cast<float>(frame / fps));
                scales.insert(scales.end(), 3, frame % 2 == 0 ? 0.0f : 1.0f);
            }
            file.animate(1, "scale", interpolation, times, scales);
            const test::TemporaryFolder folder;
            const std::filesystem::path path[] = {folder.write("a.glb", file.glb())};
            std::vector<GltfShot> shots = openShots(path, {}, fps);
            const MovingLamps lamps(shots, {}, {}, {0, 0, 0});
            for (int frame = 0; frame <= 120; ++frame)
                ASSERT_EQ(lamps.at(frame).front().gain, Rgb(frame % 2 == 0 ? 0.0f : 1.0f))
                    << frame << " at " << fps << ", " << interpolation;
        }
    }
}

TEST(GltfLamps, AreOffWhereTheyAreHiddenOrSwitchedOff) {
    GltfBuilder file = setWith({{"type", "point"}});
    EXPECT_TRUE(loaded(file, {.lamps = false}).lamps.empty());
    file.json["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = false;
    EXPECT_TRUE(loaded(file).lamps.empty());
}

TEST(LampGain, IsOfTheLastPatternThatMatches) {
    const auto gainOf = [](std::vector<LampGain> gains) {
        MeshOptions options;
        options.gains = std::move(gains);
        return lampOf({{"type", "point"}, {"name", "desk left"}}, Json::object(), options).gain;
    };
    EXPECT_EQ(gainOf({}), Rgb(1, 1, 1));
    EXPECT_EQ(gainOf({parseLampGain("*=0"), parseLampGain("desk*=2,1,0.5")}), Rgb(2, 1, 0.5f));
    EXPECT_EQ(gainOf({parseLampGain("desk=3")}), Rgb(1, 1, 1));
    EXPECT_TRUE(matchesPattern("*", ""));
    EXPECT_TRUE(matchesPattern("d*k*", "desk left"));
    EXPECT_FALSE(matchesPattern("d*t*x", "desk left"));
    EXPECT_TRUE(matchesPattern("a*ab", "aaab"));
}

TEST(LampGain, OfBadTextIsRefused) {
    for (const char* text :
         {"desk", "=1", "desk=-1", "desk=nan", "desk=inf", "desk=1,2", "desk=", "desk=2e6"})
        EXPECT_THROW(parseLampGain(text), Error) << text;
    test::expectError([] { parseLampGain("desk=-1"); }, "--lamp desk=-1", "0 to 1e6");
    const TriangleMesh mesh = loaded(setWith({{"type", "point"}, {"name", "desk"}}));
    const LampGain known[] = {parseLampGain("d*=2")}, unknown[] = {parseLampGain("dusk=2")};
    EXPECT_NO_THROW(requireMatches(known, lampNames(mesh)));
    test::expectError([&] { requireMatches(unknown, lampNames(mesh)); }, "--lamp dusk",
                      "did you mean desk?");
}

}  // namespace
}  // namespace shadowcache
