// Files and messages of the programs; spacings that are times the chosen one; statistics,
// metadata, stale caches, merging, `--debug`.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "common/base/exit_status.h"
#include "common/cache/cache_items.h"
#include "common/image/exr.h"
#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

Json readJson(const std::filesystem::path& path) {
    return Json::parse(readBytes(path));
}

/// Expects positive numbers under all these dotted keys.
void expectNumbers(const Json& stats, const std::vector<std::string>& keys) {
    for (std::string key : keys) {
        std::replace(key.begin(), key.end(), '.', '/');
        const Json::json_pointer pointer("/" + key);
        ASSERT_TRUE(stats.contains(pointer)) << key;
        EXPECT_GT(stats[pointer].get<double>(), 0) << key;
    }
}

std::vector<std::string> channelNames(const ExrFile& file) {
    std::vector<std::string> names;
    for (const Channel& channel : file.channels) names.push_back(channel.name);
    std::sort(names.begin(), names.end());
    return names;
}

void expectSamePicture(const ExrFile& a, const ExrFile& b) {
    ASSERT_EQ(channelNames(a), channelNames(b));
    for (std::size_t k = 0; k < a.channels.size(); ++k)
        EXPECT_EQ(a.channels[k].values, b.channels[k].values) << a.channels[k].name;
}

class Cli : public CliTest {};

TEST_F(Cli, BakeSaysWhatItTook) {
    const auto result =
        runWell("bake", "set.obj -o set.vdb --spacing 0.25 --stats stats.json --threads 2");
    // No progress and nothing else that a terminal wants: two lines of report.
    EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 2) << result.out;
    EXPECT_EQ(result.out.find_first_of("\r\033"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("4 triangles"), std::string::npos) << result.out;
    const Json stats = readJson(path("stats.json"));
    expectNumbers(stats, {"seconds.load", "seconds.build", "seconds.bake", "rays.bake",
                          "cache.items", "cache.bytes", "peak_rss_bytes"});
    EXPECT_EQ(stats["cache"]["bytes"], std::filesystem::file_size(path("set.vdb")));
}

TEST_F(Cli, BakeSaysWhichSpacingItChose) {
    const auto result = runWell("bake", "set.obj -o set.vdb --level 0 --rays 1");
    EXPECT_NE(result.out.find("(chosen from the set's size)"), std::string::npos) << result.out;
}

TEST_F(Cli, BakeTakesTimesTheChosenSpacing) {
    const auto spacing = [this](const std::string& arguments) {
        runWell("bake", "set.obj --level 0 --rays 1 --stats stats.json " + arguments);
        return readJson(path("stats.json"))["cache"]["spacing"].get<double>();
    };
    const double chosen = spacing("--estimate");
    EXPECT_EQ(spacing("--estimate --spacing 2x"), 2 * chosen);
    EXPECT_EQ(spacing("--estimate --spacing .5x"), chosen / 2);
    EXPECT_EQ(spacing("-o coarse.vdb --spacing 16x"), 16 * chosen);
    EXPECT_EQ(spacing("-o more.vdb --extend coarse.vdb --spacing 16x"), 16 * chosen);
    EXPECT_EQ(spacing("-o more.vdb --extend coarse.vdb"), 16 * chosen);
    const std::string other =
        "set.obj --level 0 --rays 1 -o more.vdb --extend coarse.vdb --spacing ";
    for (const char* times : {"8x", "1x"}) {
        const ProgramRun refused = run("bake", other + times);
        EXPECT_NE(refused.status, 0) << times;
        EXPECT_NE(refused.err.find("spacing"), std::string::npos) << refused.err;
    }
}

TEST_F(Cli, RenderSaysWhatItTook) {
    bake();
    const auto result = runWell("render", still("--cache set.vdb -o a.exr --stats stats.json"));
    EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 2) << result.out;
    EXPECT_EQ(result.out.find_first_of("\r\033"), std::string::npos) << result.out;
    const Json stats = readJson(path("stats.json"));
    expectNumbers(
        stats, {"seconds.load", "seconds.build", "seconds.render", "seconds.setup", "seconds.trace",
                "rays.camera", "rays.shadow", "cache.items", "cache.bytes", "peak_rss_bytes"});
    EXPECT_GE(stats["rays"]["camera"].get<int>(), 12 * 8);
}

// Control: a looser target takes fewer camera rays and leaves more error.
TEST_F(Cli, TargetErrorChoosesTheCameraRays) {
    const std::string still =
        "set.obj --env map.exr --eye 1,1.5,2 --look-at 0,0.3,0 --size 48x32 --estimator mis ";
    runWell("render", still + "--camera-rays 128 --samples 32 -o ref.exr");
    double error[2], rays[2];
    for (int i = 0; i < 2; ++i) {
        const std::string target = i == 0 ? "0.02" : "0.002";
        runWell("render", still + "--target-error " + target +
                              " -o a.exr --reference ref.exr --stats stats.json");
        const Json stats = readJson(path("stats.json"));
        error[i] = stats["error"]["relmse"];
        rays[i] = stats["camera_rays_a_pixel"];
        EXPECT_LT(error[i], 4 * std::stod(target));
        EXPECT_LT(stats["error"]["by_own_variance"].get<double>(), 6 * std::stod(target));
    }
    EXPECT_LT(rays[0], rays[1]);
    EXPECT_GT(error[0], error[1]);
}

TEST_F(Cli, SppIsCameraRaysOfOneSample) {
    const std::string view = "set.obj --env map.exr --camera camera.json --size 12x8 ";
    runWell("render", view + "--spp 9 -o a.exr");
    runWell("render", view + "--camera-rays 9 --samples 1 -o b.exr");
    expectSamePicture(readExr(path("a.exr")), readExr(path("b.exr")));
}

TEST_F(Cli, ProgressiveEndsWithWhatIsThere) {
    bake();
    const std::string view = "set.obj --env map.exr --camera camera.json --cache set.vdb ";
    const std::string passes = view + "--size 24x16 --pass-rays 4 --progressive --resume ";
    runWell("render", passes + "--spp 12 -o a.exr");
    runWell("render", view + "--size 24x16 --pass-rays 4 --spp 12 -o b.exr");
    expectSamePicture(readExr(path("a.exr")), readExr(path("b.exr")));
    EXPECT_EQ(readExr(path("a.exr")).metadata.at("shadowcache:camera-rays-done"), "12");
    // Out of time after some pass: a picture all the same, which --resume keeps.
    const std::string limited = passes + "--spp 65536 --time-limit 0.5 -o c.exr";
    EXPECT_NE(runWell("render", limited).out.find("out of time"), std::string::npos);
    EXPECT_LT(std::stoi(readExr(path("c.exr")).metadata.at("shadowcache:camera-rays-done")), 65536);
    EXPECT_NE(runWell("render", limited).out.find("0 frames (1 more was done)"), std::string::npos);
    // Interrupted: a picture, too, but not the one that was asked for: --resume renders it again.
    const auto written = [this] {
        std::error_code missing;
        return std::filesystem::last_write_time(path("d.exr"), missing);
    };
    RunLimits limits;
    limits.interruptWhen = [&, before = written()] { return written() != before; };
    const std::string endless = passes + "--spp 65536 -o d.exr";
    const auto run = CliTest::run("render", endless, limits);
    EXPECT_EQ(run.status, kTryAgain) << run.err;
    EXPECT_NE(run.out.find("interrupted after"), std::string::npos) << run.out;
    EXPECT_TRUE(readExr(path("d.exr")).metadata.contains("shadowcache:incomplete"));
    EXPECT_NE(CliTest::run("render", endless + " --check").err.find("d.exr: incomplete"),
              std::string::npos);
    limits.interruptWhen = [&, before = written()] { return written() != before; };
    const auto again = CliTest::run("render", endless, limits);
    EXPECT_NE(again.out.find("rendered again"), std::string::npos) << again.out;
}

TEST_F(Cli, BiasIsSaid) {
    bake();
    const auto biasOf = [&](const std::string& options) {
        runWell("render", still(options + " --cache set.vdb -o bias.exr --stats bias.json"));
        const std::string said = readExr(path("bias.exr")).metadata.at("shadowcache:bias");
        EXPECT_EQ(readJson(path("bias.json"))["bias"].get<std::string>(), said);
        return said;
    };
    for (const char* name : {"mis", "cache"})
        EXPECT_EQ(biasOf(std::string("--estimator ") + name), "none") << name;
    for (const char* options : {"--preview", "--preview --samples 0"})
        EXPECT_NE(biasOf(options), "none") << options;
}

/// What a run says that it wrote is there, and is all that it wrote.
TEST_F(Cli, NamesThatArePrintedAreThoseThatWereWritten) {
    const std::pair<std::string, std::string> runs[]{
        {"-o take#2.exr", "take#2.exr"},
        {"-o take%d.exr", "take%d.exr"},
        {"-o still.####.exr", "still.0001.exr"},
        {"-o take#2.exr --frames 7", "take72.exr"},
        {"-o take#2.####.exr --frames -7", "take#2.-0007.exr"}};
    for (const auto& [options, name] : runs) {
        const auto before = files();
        EXPECT_NE(runWell("render", still(options)).out.find(" -> " + name + "\n"),
                  std::string::npos)
            << options;
        auto made = files();
        std::erase_if(made, [&](const std::string& file) {
            return std::find(before.begin(), before.end(), file) != before.end();
        });
        EXPECT_EQ(made, std::vector<std::string>{name}) << options;
    }
}

TEST_F(Cli, FramesMakeTheirFiles) {
    const auto before = files();
    runWell("render", move("--frames 1-5x2 -o f.####.exr --png"));
    runWell("render", move("--frames 3-4 -o g_%03d.exr"));
    runWell("render", move("--frames 5,2 -o h#.exr"));
    auto made = files();
    std::erase_if(made, [&](const std::string& name) {
        return std::find(before.begin(), before.end(), name) != before.end();
    });
    EXPECT_EQ(made, (std::vector<std::string>{"f.0001.exr", "f.0001.png", "f.0003.exr",
                                              "f.0003.png", "f.0005.exr", "f.0005.png", "g_003.exr",
                                              "g_004.exr", "h2.exr", "h5.exr"}));
    EXPECT_EQ(readBytes(path("f.0001.png")).substr(1, 3), "PNG");
    // A frame is the same whatever frames surround it.
    runWell("render", move("--frames 3 -o single.exr"));
    expectSamePicture(readExr(path("single.exr")), readExr(path("f.0003.exr")));
}

TEST_F(Cli, PictureHoldsItsChannelsAndItsOrigin) {
    bake();
    runWell("render", still("--cache set.vdb --half --seed 7 -o a.exr --aov "
                            "irradiance albedo normal position depth variance "
                            "rays"));
    const ExrFile file = readExr(path("a.exr"));
    EXPECT_EQ(file.width, 12);
    EXPECT_EQ(file.height, 8);
    EXPECT_EQ(channelNames(file),
              (std::vector<std::string>{"B", "G", "R", "albedo.B", "albedo.G", "albedo.R",
                                        "depth.Z", "irradiance.B", "irradiance.G", "irradiance.R",
                                        "normal.X", "normal.Y", "normal.Z", "position.X",
                                        "position.Y", "position.Z", "rays.Y", "variance.Y"}));
    for (const auto& [key, value] : std::map<std::string, std::string>{{"SET", "set.obj"},
                                                                       {"env", "map.exr"},
                                                                       {"cache", "set.vdb"},
                                                                       {"samples", "4"},
                                                                       {"seed", "7"},
                                                                       {"albedo", "0.5"},
                                                                       {"eye", "1,1.5,2"},
                                                                       {"frame", "1"}}) {
        ASSERT_TRUE(file.metadata.contains("shadowcache:" + key)) << key;
        EXPECT_EQ(file.metadata.at("shadowcache:" + key), value);
    }
    for (const char* key : {"version", "seconds", "fingerprint"})
        EXPECT_TRUE(file.metadata.contains(std::string("shadowcache:") + key)) << key;
}

TEST_F(Cli, AovsHaveTheNamesOfArnold) {
    bake();
    const std::string aovs =
        "--cache set.vdb --aov normal axial_depth diffuse_color variance depth -o ";
    runWell("render", still(aovs + "ours.exr"));
    runWell("render", still(aovs + "theirs.exr --aov-names arnold"));
    const ExrFile ours = readExr(path("ours.exr")), theirs = readExr(path("theirs.exr"));
    EXPECT_EQ(channelNames(theirs),
              (std::vector<std::string>{"B", "G", "N.X", "N.Y", "N.Z", "R", "Z", "depth.Z",
                                        "diffuse_albedo.B", "diffuse_albedo.G", "diffuse_albedo.R",
                                        "variance.B", "variance.G", "variance.R"}));
    const auto valuesOf = [](const ExrFile& file, const std::string& name) {
        return std::ranges::find(file.channels, name, &Channel::name)->values;
    };
    for (const auto& [from, to] :
         std::map<std::string, std::string>{{"normal.X", "N.X"},
                                            {"normal.Y", "N.Y"},
                                            {"axial_depth.Z", "Z"},
                                            {"depth.Z", "depth.Z"},
                                            {"diffuse_color.G", "diffuse_albedo.G"},
                                            {"variance.Y", "variance.B"}})
        EXPECT_EQ(valuesOf(ours, from), valuesOf(theirs, to)) << from;
    EXPECT_NE(valuesOf(theirs, "Z"), valuesOf(theirs, "depth.Z"));  // the control
    EXPECT_EQ(run("render", still("--aov-names noice -o bad.exr")).status, 2);
}

TEST_F(Cli, ThreadsChangeNoBit) {
    runWell("bake", "set.obj -o one.vdb --spacing 0.1 --threads 1");
    runWell("bake", "set.obj -o two.vdb --spacing 0.1 --threads 2");
    CacheHeader header;
    const CacheItems one = readCache(path("one.vdb"), header);
    const CacheItems two = readCache(path("two.vdb"), header);
    EXPECT_EQ(one.voxel, two.voxel);
    EXPECT_EQ(one.n, two.n);
    EXPECT_EQ(one.d, two.d);
    ASSERT_EQ(one.blocks.size(), two.blocks.size());
    for (std::size_t b = 0; b < one.blocks.size(); ++b) {
        EXPECT_EQ(one.blocks[b].n, two.blocks[b].n);
        EXPECT_EQ(one.blocks[b].d, two.blocks[b].d);
    }
    for (const std::string estimator : {"mis", "paper", "cache"}) {
        const auto picture = [&](const std::string& options) {
            return still("--aov variance rays --cache one.vdb --camera-rays 2 --estimator " +
                             estimator + options,
                         "48x32");
        };
        runWell("render", picture(" -o one.exr --threads 1"));
        runWell("render", picture(" -o two.exr --threads 2"));
        expectSamePicture(readExr(path("one.exr")), readExr(path("two.exr")));
    }
}

TEST_F(Cli, StaleCacheIsUsedOnlyKnowingly) {
    bake();
    const std::string other = "other.obj --env map.exr --eye 1,1,2 --look-at 0,0,0 --size 8x8 ";
    const auto before = files();
    expectRefusal(run("render", other + "--cache set.vdb -o a.exr"), "render", "set.vdb",
                  "--stale-ok");
    EXPECT_EQ(files(), before);
    const auto result = run("render", other + "--cache set.vdb --stale-ok -o a.exr");
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.err.rfind("shadowcache-render: warning: set.vdb: ", 0), 0u) << result.err;
    EXPECT_TRUE(std::filesystem::exists(path("a.exr")));
}

TEST_F(Cli, MendedMapsAreReported) {
    std::vector<float> values(16 * 16, 0.5f);
    values[3] = -1;
    values[4] = std::numeric_limits<float>::quiet_NaN();
    writeExr(path("square.exr"), 16, 16, {{"R", values}, {"G", values}, {"B", values}}, {},
             PixelType::full);
    const auto result = run("render",
                            "set.obj --env square.exr --eye 1,1,2 --look-at 0,0,0 --size 8x8 "
                            "-o a.exr");
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.err,
              "shadowcache-render: warning: square.exr: 16x16 texels, a lat-long map is 2:1\n");
    EXPECT_NE(result.out.find("map: 1 texels not a number and 1 negative"), std::string::npos)
        << result.out;
}

TEST_F(Cli, InfoTellsWhatABakeMade) {
    bake("--stats stats.json --seed 9 --rays 8");
    const Json info = Json::parse(runWell("info", "set.vdb --json").out);
    const Json stats = readJson(path("stats.json"));
    EXPECT_EQ(info["items"], stats["cache"]["items"]);
    EXPECT_EQ(info["blocks"], stats["cache"]["blocks"]);
    EXPECT_EQ(info["bytes"]["file"], stats["cache"]["bytes"]);
    EXPECT_EQ(info["level"], 3);
    EXPECT_EQ(info["rays"], 8);
    EXPECT_EQ(info["seeds"], "9");
    EXPECT_EQ(info["spacing"], 0.25);
    EXPECT_EQ(info["refinement"], "adaptive");
    EXPECT_EQ(info["up_axis"], "y");
    EXPECT_LE(info["bounds"]["low"][0], -1);
    EXPECT_GE(info["bounds"]["high"][2], 1);
    int items = 0;
    for (const Json& bin : info["openness"]) items += bin.get<int>();
    EXPECT_EQ(info["items"], items);
    const std::string text = runWell("info", "set.vdb").out;
    EXPECT_NE(text.find(info["fingerprint"].get<std::string>()), std::string::npos) << text;
}

TEST_F(Cli, MergeAddsSeedsAndRefusesOtherSets) {
    bake();
    runWell("bake", "set.obj -o second.vdb --spacing 0.25 --level 3 --seed 2");
    runWell("bake", "other.obj -o other.vdb --spacing 0.25 --level 3");
    runWell("merge", "set.vdb second.vdb -o sum.vdb");
    EXPECT_EQ(Json::parse(runWell("info", "sum.vdb --json").out)["seeds"], "1,2");
    const auto before = files();
    expectRefusal(run("merge", "set.vdb other.vdb -o bad.vdb"), "merge", "other.vdb",
                  "fingerprint");
    EXPECT_EQ(files(), before);
}

TEST_F(Cli, ReferenceGivesTheError) {
    runWell("render", still("-o a.exr"));
    runWell("render", still("--seed 2 -o b.exr --reference a.exr --stats s.json"));
    expectNumbers(readJson(path("s.json")), {"error.relmse", "error.p99", "error.max"});
}

TEST_F(Cli, CropWritesAPartOfTheFrame) {
    const std::string picture = still("--camera-rays 3 --reference whole.exr --png -o ", "32x20");
    runWell("render", still("--camera-rays 3 -o whole.exr", "32x20"));
    const auto run = runWell("render", picture + "part.exr --crop 5,3,20x11");
    EXPECT_NE(run.out.find("relMSE 0 "), std::string::npos) << run.out;
    const ExrFile part = readExr(path("part.exr"));
    EXPECT_EQ(part.width, 20);
    EXPECT_EQ(part.height, 11);
    EXPECT_EQ(part.place.x, 5);
    EXPECT_EQ(part.place.y, 3);
    EXPECT_EQ(part.place.frameWidth, 32);
    EXPECT_EQ(part.place.frameHeight, 20);
    // As large, but of another part of the frame.
    expectRefusal(
        this->run("render", still("--crop 6,3,20x11 --reference part.exr -o other.exr", "32x20")),
        "render", "part.exr", "of another part of the frame");
    // Control: with another filter the pixels are others.
    const auto box = runWell("render", picture + "box.exr --crop 5,3,20x11 --filter box");
    EXPECT_EQ(box.out.find("relMSE 0 "), std::string::npos) << box.out;
}

TEST_F(Cli, DebugTellsOfAPixelAndWritesNothing) {
    bake();
    runWell("render", still("--cache set.vdb -o a.exr"));
    const auto before = files();
    const auto result = runWell("render", still("--cache set.vdb -o b.exr --debug 6,4"));
    EXPECT_EQ(files(), before);
    for (const char* text :
         {"position: ", "normal: ", "cache items: ", "sample 3: ", "irradiance: "})
        EXPECT_NE(result.out.find(text), std::string::npos) << text << " in " << result.out;
    // The same numbers as in the picture.
    const ExrFile picture = readExr(path("a.exr"));
    const auto red = std::find_if(picture.channels.begin(), picture.channels.end(),
                                  [](const Channel& c) { return c.name == "R"; });
    char color[32];
    std::snprintf(color, sizeof color, "colour: %.9g,",
                  static_cast<double>(red->values[4 * 12 + 6]));
    EXPECT_NE(result.out.find(color), std::string::npos) << color << " in " << result.out;
}

TEST_F(Cli, HelpEndsInExamples) {
    for (const std::string program : {"bake", "render", "info", "merge", "make-set"}) {
        const auto result = runWell(program, "--help");
        const auto example = result.out.rfind("Example");
        ASSERT_NE(example, std::string::npos) << program;
        EXPECT_NE(result.out.find("  shadowcache-" + program, example), std::string::npos);
    }
}

TEST_F(Cli, MemoryChangesNoPicture) {
    bake();
    runWell("render", still("--cache set.vdb -o whole.exr"));
    const auto result =
        runWell("render", still("--cache set.vdb -o parts.exr --memory 0.5G --stats stats.json"));
    EXPECT_NE(result.out.find(" dropped again"), std::string::npos) << result.out;
    expectSamePicture(readExr(path("whole.exr")), readExr(path("parts.exr")));
    const Json stats = readJson(path("stats.json"));
    expectNumbers(stats, {"cache.items", "cache.bytes", "cache.memory.peak", "cache.memory.loads",
                          "cache.memory.bytes_read"});
    EXPECT_EQ(stats["cache"]["memory"]["budget"], 1 << 29);
    EXPECT_EQ(stats["cache"]["memory"]["drops"], 0);
    // A picture that is done is done with any budget.
    EXPECT_NE(runWell("render", still("--cache set.vdb -o whole.exr --resume --memory 1G"))
                  .out.find("1 more was done"),
              std::string::npos);

    const auto scant = run("render", still("--cache set.vdb -o parts.exr --memory 1k"));
    EXPECT_EQ(scant.status, 0);
    EXPECT_NE(scant.err.find("warning: --memory 1024: "), std::string::npos) << scant.err;
    expectSamePicture(readExr(path("whole.exr")), readExr(path("parts.exr")));
}

}  // namespace
}  // namespace shadowcache::test
