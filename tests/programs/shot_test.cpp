// Shots from glTF sets, through the programs.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

#include "common/image/exr.h"
#include "tests/support/cli_fixture.h"
#include "tests/support/gltf_posed.h"

namespace shadowcache::test {
namespace {

/// A floor, 3 x 3 squares over it as instances, a square that moves, and a camera that moves.
std::string shotGlb() {
    GltfBuilder file = squareGltf();
    const float h = std::sqrt(0.5f);
    const nlohmann::json flat{-h, 0, 0, h};
    file.root({{"mesh", 0}, {"rotation", flat}, {"scale", {4, 4, 4}}, {"translation", {-2, 0, 2}}});
    for (const double x : {-1.25, -0.25, 0.75})
        for (const double z : {-0.75, 0.25, 1.25})
            file.root({{"mesh", 0},
                       {"rotation", flat},
                       {"scale", {0.5, 0.5, 0.5}},
                       {"translation", {x, 0.5, z}}});
    const int mover = file.root({{"mesh", 0}, {"name", "mover"}, {"scale", {0.4, 0.4, 0.4}}});
    file.animate(mover, "translation", "LINEAR", {0, 1}, {-2, 1, 0, 2, 1, 0});
    const int lens = file.append(
        "cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
    const int camera =
        file.root({{"camera", lens}, {"name", "shot"}, {"rotation", {-0.2, 0, 0, 0.98}}});
    file.animate(camera, "translation", "LINEAR", {0, 1}, {0, 2, 3, 0.5, 2, 3});
    const int flatLens = file.append(
        "cameras",
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 8.0 / 3}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 9}}}});
    file.root(
        {{"camera", flatLens}, {"name", "plan"}, {"rotation", flat}, {"translation", {0, 3, 0}}});
    return file.glb();
}

class ShotTest : public CliTest {
protected:
    ShotTest() { folder_.write("shot.glb", shotGlb()); }

    static std::string shot(const std::string& options) {
        return "shot.glb --env map.exr --samples 4 --size 16x12 " + options;
    }

    std::vector<float> red(const std::string& name) const {
        const ExrFile file = readExr(path(name));
        for (const Channel& channel : file.channels)
            if (channel.name == "R") return channel.values;
        throw Error(name + " has no R");
    }
};

TEST_F(ShotTest, BakesOnceAndRendersTheMove) {
    const auto bake = runWell("bake", "shot.glb -o shot.vdb --spacing 0.25 --level 3");
    EXPECT_NE(bake.out.find("10 instances"), std::string::npos) << bake.out;
    const auto render = runWell(
        "render", shot("--cache shot.vdb --camera shot --frames 1-24x11 -o f.%04d.exr --png"));
    EXPECT_NE(render.out.find("moving: 2 triangles"), std::string::npos) << render.out;
    EXPECT_NE(render.out.find("cache: 3 frames"), std::string::npos) << render.out;
    EXPECT_NE(red("f.0001.exr"), red("f.0023.exr"));
    runWell("render", shot("--cache shot.vdb --camera plan --frames 3 -o plan.exr"));
    // From straight above the orthographic view holds the floor and nothing else.
    for (const float value : red("plan.exr")) EXPECT_LT(value, 15);
}

/// Spacing that a bake of the shot chooses.
double spacingOf(const ProgramRun& bake) {
    const std::string before = "spacing ";
    return std::stod(bake.out.substr(bake.out.find(before) + before.size()));
}

TEST_F(ShotTest, SpacingIsAsFineAsThePicturesAreWorth) {
    const auto spacing = [&](const std::string& options) {
        return spacingOf(runWell(
            "bake", "shot.glb -o a.lookups --lookups-only --camera shot --frames 1 " + options));
    };
    const double small = spacing("--size 32x24"), large = spacing("--size 640x480");
    EXPECT_GT(small, 2 * large);
    EXPECT_GT(spacing("--size 640x480 --quality draft"), 1.5 * large);
    EXPECT_LT(spacing("--size 32x24 --quality fine"), small / 1.5);
    // Times the spacing for the set's size, whatever the shot is.
    const double twice = spacing("--size 32x24 --spacing 2x");
    EXPECT_EQ(twice, spacing("--size 640x480 --spacing 2x"));
    EXPECT_LE(twice / 2, large);
    EXPECT_EQ(run("bake", "shot.glb -o a.vdb --spacing 1 --quality fine").status, 2);
}

TEST_F(ShotTest, ShardsOfAShotHaveTheSpacingOfTheWhole) {
    const std::string bake = "shot.glb --camera shot --frames 1 --size 32x24 --level 2 --rays 1 ";
    const double whole = spacingOf(runWell("bake", bake + "-o whole.vdb"));
    EXPECT_EQ(spacingOf(runWell("bake", bake + "-o part.vdb --shard 1/2")), whole);
    runWell("bake", bake + "-o a.lookups --lookups-only");
    EXPECT_EQ(spacingOf(runWell("bake", bake + "-o part.vdb --shard 2/2 --lookups a.lookups")),
              whole);
    EXPECT_EQ(spacingOf(runWell("bake",
                                "shot.glb -o more.vdb --extend whole.vdb --camera shot --frames 9 "
                                "--size 640x480 --level 2 --rays 1")),
              whole);
}

// One cache serves whatever lamps give.
TEST_F(ShotTest, DimsLampsByName) {
    test::GltfBuilder file = test::squareGltf();
    file.root({{"mesh", 0}});
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"name", "desk"}, {"intensity", 4}}};
    file.root({{"translation", {0.5, 0.5, 1}},
               {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    folder_.write("lit.glb", file.glb());
    EXPECT_NE(runWell("render", "lit.glb --list").out.find("lamp desk: point, intensity 4,4,4"),
              std::string::npos);
    runWell("bake", "lit.glb -o lit.vdb --spacing 0.25");
    const auto picture = [&](const std::string& more, const std::string& name) {
        runWell("render", "lit.glb --eye 0.5,0.5,2 --look-at 0.5,0.51,0 --size 8x8 --spp 4 -o " +
                              name + " --cache lit.vdb " + more);
        return red(name);
    };
    const auto usual = picture("", "a.exr"), dimmed = picture("--lamp d*=0.5,1,1", "b.exr");
    ASSERT_EQ(usual.size(), dimmed.size());
    float most = 0;
    for (std::size_t i = 0; i < usual.size(); ++i) {
        EXPECT_NEAR(dimmed[i], 0.5f * usual[i], 1e-5f);
        most = std::max(most, usual[i]);
    }
    EXPECT_GT(most, 0.1f);
}

// A wall 3 m before the camera and a floor behind it: what lies beyond zfar is sky.
TEST_F(ShotTest, CamerasOfGltfHaveClipPlanesThatAreNamed) {
    const auto write = [&](double near, double far) {
        GltfBuilder file = squareGltf();
        file.root({{"mesh", 0}, {"translation", {-0.5, -0.5, -3}}});
        const int lens = file.append(
            "cameras", {{"type", "perspective"},
                        {"perspective",
                         {{"yfov", 0.1}, {"aspectRatio", 1.0}, {"znear", near}, {"zfar", far}}}});
        file.root({{"camera", lens}, {"name", "eye"}});
        folder_.write("wall.glb", file.glb());
    };
    const std::string command =
        "wall.glb --env 2,2,2 --albedo 0.25 --bounces 0 --camera eye --spp 16 -o a.exr --size ";
    const auto mean = [&] {
        const std::vector<float> values = red("a.exr");
        return std::accumulate(values.begin(), values.end(), 0.0f) /
               static_cast<float>(values.size());
    };
    write(0.1, 3.5);
    EXPECT_EQ(runWell("render", command + "4x4").out.find("the set reaches"), std::string::npos);
    EXPECT_NEAR(mean(), 0.5f, 0.05f);
    write(0.1, 2.5);
    const auto clipped = runWell("render", command + "4x4");
    EXPECT_NE(clipped.out.find("camera eye: sees up to 2.5 m along the view, the set reaches 3 m"),
              std::string::npos)
        << clipped.out;
    EXPECT_EQ(mean(), 2);
    write(3.25, 9);
    runWell("render", command + "4x4");
    EXPECT_EQ(mean(), 2);
    EXPECT_NE(runWell("render", "wall.glb --list").out.find("sees from 3.25 to 9 m away"),
              std::string::npos);
    const auto wide = run("render", command + "8x4");
    EXPECT_EQ(wide.status, 0);
    EXPECT_NE(wide.err.find("warning: camera eye: made for pictures 1 times as wide as high"),
              std::string::npos)
        << wide.err;
}

TEST_F(ShotTest, CamerasThatAreMirroredOrShearedAreNamed) {
    const auto warning = [&](const nlohmann::json& parent) {
        GltfBuilder file = squareScene();
        const int lens = file.append(
            "cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}});
        nlohmann::json node = parent;
        node["children"] = {file.append("nodes", {{"camera", lens},
                                                  {"name", "eye"},
                                                  {"rotation", {0, 0, 0.38268343, 0.92387953}},
                                                  {"translation", {0.5, 0.5, 3}}})};
        file.root(node);
        folder_.write("eye.glb", file.glb());
        const auto result =
            run("render", "eye.glb --env 1,1,1 --camera eye --size 4x4 --spp 1 -o a.exr");
        EXPECT_EQ(result.status, 0) << result.err;
        return result.err;
    };
    EXPECT_EQ(warning({{"scale", {2, 2, 2}}}), "");
    EXPECT_NE(warning({{"scale", {-1, 1, 1}}}).find("camera eye: a scale below 0"),
              std::string::npos);
    EXPECT_NE(warning({{"scale", {1, 2, 1}}}).find("camera eye: a parent's scale shears it"),
              std::string::npos);
}

// Where a lamp is in frames that nobody asks for is no reason to refuse.
TEST_F(ShotTest, LampsOutOfReachRefuseTheirFramesAlone) {
    GltfBuilder file = squareScene();
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"name", "comet"}, {"intensity", 4}}};
    const int node = file.root({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    file.animate(node, "translation", "STEP", {0, 0.5, 1}, {1e20f, 0, 0, 0.5, 0.5, 1, 1e20f, 0, 0});
    folder_.write("lit.glb", file.glb());
    const std::string command =
        "lit.glb --eye 0.5,0.5,2 --look-at 0.5,0.51,0 --size 4x4 --spp 4 --lamp comet=2 -o ";
    runWell("render", command + "f.####.exr --frames 12-14");
    EXPECT_GT(std::ranges::max(red("f.0013.exr")), 0.1f);
    for (const std::string frame : {"1", "24", "12,24"})
        expectRefusal(run("render", command + "a.####.exr --frames " + frame), "render", "lit.glb",
                      "lamp comet: is not within 1e+12 of the origin");
}

TEST_F(ShotTest, ListsWhatAFileHolds) {
    const auto list = runWell("render", "shot.glb --list");
    for (const std::string text :
         {"11 nodes place 22 triangles", "camera shot: perspective", "camera plan: orthographic",
          "moves: mover", "frame 24 at 24 frames a second"})
        EXPECT_NE(list.out.find(text), std::string::npos) << list.out;
    expectRefusal(run("render", shot("--camera nobody -o a.exr")), "render", "nobody",
                  "shot, plan");
    expectRefusal(run("render", "set.obj --list"), "render", "set.obj",
                  "--list supports glTF only");
}

TEST_F(ShotTest, ResumesWhatIsMissingBrokenOrOfOtherSettings) {
    const std::string command = "--camera shot --frames 1-4 --resume -o f.####.exr";
    runWell("render", shot(command));
    const auto stamp = [&](int frame) {
        return std::filesystem::last_write_time(path(fmt::format("f.000{}.exr", frame)));
    };
    const auto first = stamp(1), last = stamp(4);
    std::filesystem::remove(path("f.0002.exr"));
    const std::string whole = readBytes(path("f.0003.exr"));
    folder_.write("f.0003.exr", whole.substr(0, whole.size() / 2));
    const auto again = runWell("render", shot(command + " --threads 1"));
    EXPECT_NE(again.out.find("2 frames (2 more were done)"), std::string::npos) << again.out;
    EXPECT_NE(again.out.find("f.0003.exr: incomplete"), std::string::npos) << again.out;
    EXPECT_EQ(stamp(1), first);
    EXPECT_EQ(stamp(4), last);
    EXPECT_EQ(readExr(path("f.0003.exr")).channels.size(), 3u);
    // Other frames of the same settings leave the done ones alone; other settings do not.
    const auto fewer = runWell("render", shot("--camera shot --frames 3-5 --resume -o f.####.exr"));
    EXPECT_NE(fewer.out.find("1 frame (2 more were done)"), std::string::npos) << fewer.out;
    const auto other = runWell("render", shot(command + " --seed 2"));
    EXPECT_NE(other.out.find("4 frames (0 more were done)"), std::string::npos) << other.out;
    folder_.write("map.exr", readBytes(path("map.exr")) + " ");
    const auto light = runWell("render", shot(command + " --seed 2"));
    EXPECT_NE(light.out.find("4 frames (0 more"), std::string::npos) << light.out;
}

TEST_F(ShotTest, CheckNamesTheFramesThatAreNotDone) {
    const std::string command = "--camera shot --frames 1-4 -o f.####.exr";
    runWell("render", shot(command));
    const std::vector<std::string> before = files();
    EXPECT_EQ(runWell("render", shot(command + " --check --threads 1")).out,
              "4 frames, all done -> f.####.exr\n");
    const auto faults = [&](const std::string& options) {
        const ProgramRun result = run("render", shot(command + " --check " + options));
        EXPECT_EQ(result.status, kFailed);
        return result.err;
    };
    const std::string changed = " from other settings or files\n";
    EXPECT_EQ(faults("--seed 2"), "f.0001.exr:" + changed + "f.0002.exr:" + changed +
                                      "f.0003.exr:" + changed + "f.0004.exr:" + changed +
                                      "shadowcache-render: --check: 0 of 4 frames are done, "
                                      "expected all\n");
    EXPECT_EQ(files(), before);
    std::filesystem::remove(path("f.0002.exr"));
    const std::string whole = readBytes(path("f.0003.exr"));
    folder_.write("f.0003.exr", whole.substr(0, whole.size() - 1));
    folder_.write("f.0004.exr", readBytes(path("f.0001.exr")));
    EXPECT_EQ(faults(""),
              "f.0002.exr: missing\nf.0003.exr: incomplete\nf.0004.exr:" + changed +
                  "shadowcache-render: --check: 1 of 4 frames are done, expected all\n");
}

TEST_F(ShotTest, FramesNamedTwiceAreRenderedOnce) {
    const auto run = runWell("render", shot("--camera shot --frames 1-3,2-4 -o f.####.exr"));
    EXPECT_NE(run.out.find("mis: 4 frames"), std::string::npos) << run.out;
}

TEST_F(ShotTest, ResumesWherePicturesAreMissing) {
    bake();
    const std::string line = move(
        "--cache set.vdb --frames 1-2 --aov openness --png --resume "
        "-o f.#.exr");
    runWell("render", line);
    std::filesystem::remove(path("f.2.openness.png"));
    const auto again = runWell("render", line);
    EXPECT_NE(again.out.find("1 frame (1 more was done)"), std::string::npos) << again.out;
    EXPECT_TRUE(std::filesystem::exists(path("f.2.openness.png")));
}

TEST_F(ShotTest, NeverWritesOverItsInputs) {
    const std::string map = readBytes(path("map.exr"));
    folder_.write("sky.0002.exr", map);
    const std::string line = "set.obj --samples 1 --size 4x4 --camera camera.json ";
    expectRefusal(run("render", line + "--env map.exr -o map.exr"), "render", "map.exr",
                  "is an input");
    expectRefusal(run("render", line + "--env sky.0002.exr --frames 1-3 -o ./sky.####.exr"),
                  "render", "sky.0002.exr", "is an input");
    expectRefusal(run("render", line + "--env map.exr --stats camera.json -o a.exr"), "render",
                  "camera.json", "is an input");
    EXPECT_EQ(readBytes(path("map.exr")), map);
    EXPECT_EQ(readBytes(path("sky.0002.exr")), map);
}

TEST_F(ShotTest, RelightsByListSequenceAndRotation) {
    runWell("bake", "set.obj -o set.vdb --spacing 0.25 --level 3");
    const std::string still =
        "set.obj --cache set.vdb --samples 4 --size 8x6 --eye 1,1.5,2 --look-at 0,0.3,0 ";
    for (int i = 1; i <= 3; ++i) {
        const std::vector<float> values(16 * 8, static_cast<float>(i));
        writeExr(path(fmt::format("sky.{}.exr", i)), 16, 8,
                 {{"R", values}, {"G", values}, {"B", values}}, {}, PixelType::full);
    }
    runWell("render", still + "--env sky.#.exr --frames 1-3 -o s#.exr");
    runWell("render", still + "--env sky.1.exr,sky.2.exr,sky.3.exr --frames 1-3 -o l#.exr");
    for (const std::string i : {"1", "2", "3"})
        EXPECT_EQ(red("s" + i + ".exr"), red("l" + i + ".exr"));
    EXPECT_NE(red("s1.exr"), red("s3.exr"));
    expectRefusal(run("render", still + "--env sky.1.exr,sky.2.exr --frames 1-3 -o l#.exr"),
                  "render", "--env", "2 maps for 3 frames");
    expectRefusal(run("render", still + "--env sky.#.exr --frames 1-4 -o l#.exr"), "render",
                  "sky.4.exr", "no such file");
    runWell("render", still + "--env map.exr --env-rotate -30-60 --frames 1-3 -o r#.exr");
    runWell("render", still + "--env map.exr --env-rotate 15 --frames 2 -o middle.exr");
    EXPECT_EQ(red("r2.exr"), red("middle.exr"));
    EXPECT_NE(red("r1.exr"), red("r3.exr"));
}

TEST_F(ShotTest, DynamicFilesAreRenderedAndLeaveTheCacheValid) {
    runWell("bake", "set.obj -o set.vdb --spacing 0.25 --level 3");
    folder_.write("fly.obj", "v -0.3 0 -0.3\nv 0.3 0 -0.3\nv 0.3 0 0.3\nv -0.3 0 0.3\nf 1 2 3 4\n");
    folder_.write("fly.json", R"({"frames": [{"translation": [0, 1, 0]},
                                             {"translation": [0, 1, 0], "scale": [0, 0, 0]}]})");
    const std::string line = still("--cache set.vdb ", "24x16");
    runWell("render", line + "-o without.exr");
    runWell("render", line + "--dynamic fly.obj@fly.json --frames 1-2 -o with.#.exr");
    EXPECT_NE(red("with.1.exr"), red("without.exr"));
    // In frame 2 it has no extent; the frame's number is in every seed, so compare frame by frame.
    runWell("render", line + "--frames 2 -o without2.exr");
    EXPECT_EQ(red("with.2.exr"), red("without2.exr"));
    expectRefusal(run("render", line + "--dynamic fly.obj@fly.json --frames 3 -o a.exr"), "render",
                  "fly.json", "frame 3");
}

TEST_F(ShotTest, ACacheOfOtherSidesIsStale) {
    for (const std::string name : {"floor_single_sided.gltf", "floor_double_sided.gltf"})
        folder_.write(name, readBytes(std::filesystem::path(SHADOWCACHE_CASES) / name));
    runWell("bake", "floor_single_sided.gltf -o one.vdb --spacing 0.5 --level 1 --rays 1");
    const std::string line =
        "floor_double_sided.gltf --cache one.vdb --env 1,1,1 --eye 1,3,1.001 --look-at 1,0,1 "
        "--size 9x5 "
        "--preview --spp 0 -o a.exr ";
    expectRefusal(run("render", line), "render", "one.vdb", "baked for another set");
    const ProgramRun stale = run("render", line + "--stale-ok");
    EXPECT_EQ(stale.status, 0);
    EXPECT_EQ(stale.out.find("e+"), std::string::npos) << stale.out;
}

TEST_F(ShotTest, ASetStandsStillInAFrame) {
    const float h = std::sqrt(0.5f);
    SkinnedBar bar = skinnedBar();
    bar.file.animate(bar.upper, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, h, h});
    folder_.write("bar.glb", bar.file.glb());
    const std::string look =
        "bar.glb --env 1,1,1 --eye 0.5,1,5 --look-at 0.5,1,0 --size 16x12 --samples 1 ";
    runWell("bake", "bar.glb -o bar.vdb --spacing 0.25 --level 1 --rays 1 --set-frame 12");
    runWell("render", look + "--cache bar.vdb --set-frame 12 -o still.exr");
    expectRefusal(run("render", look + "--cache bar.vdb --set-frame 24 -o a.exr"), "render",
                  "bar.vdb", "baked for another set");
    runWell("render", look + "--set-frame 24 --frames 1-2 --resume -o bent.#.exr");
    EXPECT_NE(red("still.exr"), red("bent.1.exr"));
    const auto again =
        runWell("render", look + "--set-frame 24 --frames 1-2 --resume -o bent.#.exr");
    EXPECT_NE(again.out.find("(2 more were done)"), std::string::npos) << again.out;
    const auto other =
        runWell("render", look + "--set-frame 23 --frames 1-2 --resume -o bent.#.exr");
    EXPECT_NE(other.out.find("(0 more were done)"), std::string::npos) << other.out;
}

/// Two shots whose camera files have one name.
TEST_F(ShotTest, ShotsAreToldApartByWhatTheirFilesHold) {
    std::string camera = readBytes(path("camera.json"));
    for (const char* shot : {"a", "b"}) std::filesystem::create_directory(path(shot));
    folder_.write("a/camera.json", camera);
    folder_.write("b/camera.json", camera.replace(camera.find("1.2"), 3, "1.3"));
    const auto bakeOf = [&](const std::string& shot, const std::string& more) {
        runWell("bake", "set.obj --camera " + shot +
                            "/camera.json --frames 1-2 --size 12x8 --spacing 0.25 --level 1 " +
                            more);
    };
    bakeOf("a", "--shard 1/2 -o a1.vdb");
    bakeOf("b", "--shard 2/2 -o b2.vdb");
    expectRefusal(run("merge", "a1.vdb b2.vdb -o ab.vdb"), "merge", "b2.vdb", "another shot");
    // Control: the shards of one shot, and both shots as a whole.
    bakeOf("a", "--shard 2/2 -o a2.vdb");
    runWell("merge", "a1.vdb a2.vdb -o a.vdb");
    bakeOf("b", "-o b.vdb");
    runWell("merge", "a.vdb b.vdb -o ab.vdb");
}

}  // namespace
}  // namespace shadowcache::test
