// shadowcache-render --bake: pictures while the cache is baked, and the bits of one after the
// other.

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <thread>

#include "common/base/process.h"
#include "common/random/sequence.h"
#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

namespace fs = std::filesystem;

class BakeAndRender : public CliTest {
protected:
    static constexpr const char* kShot = "set.obj --camera camera.json --frames 1-2 --size 48x32 ";

    bool exists(const std::string& name) const { return fs::exists(path(name)); }

    void expectSamePixels(const std::string& a, const std::string& b) const {
        const ExrFile one = readExr(path(a)), other = readExr(path(b));
        ASSERT_EQ(one.channels.size(), other.channels.size());
        for (std::size_t c = 0; c < one.channels.size(); ++c)
            EXPECT_TRUE(one.channels[c].values == other.channels[c].values)
                << a << ", " << b << ": " << one.channels[c].name;
    }

    bool isPreview(const std::string& name) const {
        return readExr(path(name)).metadata.contains("shadowcache:incomplete");
    }
};

TEST_F(BakeAndRender, HasTheBitsOfABakeThenARender) {
    const std::string light = "--env map.exr --spp 4 --bounces 2 ";
    struct Case {
        std::string shared, ofRender, ofBake;
    };
    for (const Case& each : {Case{"", "", ""}, Case{"", "--smooth 60 --aov items --wait", ""},
                             Case{"", "--lamps off --preview --spp 1", ""},
                             Case{"--dynamic other.obj --shutter 0.5 --up z", "", ""},
                             Case{"--threads 1", "--bake-quality draft", "--quality draft"},
                             Case{"", "--bake-spacing 0.4", "--spacing 0.4"}}) {
        SCOPED_TRACE(each.shared + each.ofRender);
        const std::string shot = kShot + each.shared + " ";
        runWell("bake", shot + each.ofBake + " -o a.vdb");
        std::string ofRender = each.ofRender;
        if (const auto at = ofRender.find("--bake-"); at != ofRender.npos) ofRender.erase(at);
        if (const auto at = ofRender.find("--wait"); at != ofRender.npos) ofRender.erase(at);
        runWell("render", shot + light + ofRender + " --cache a.vdb -o a.####.exr");
        const auto both =
            runWell("render", shot + light + each.ofRender + " --bake b.vdb -o b.####.exr");
        EXPECT_TRUE(readBytes(path("a.vdb")) == readBytes(path("b.vdb"))) << both.out;
        for (const std::string frame : {"0001", "0002"}) {
            expectSamePixels("a." + frame + ".exr", "b." + frame + ".exr");
            EXPECT_FALSE(isPreview("b." + frame + ".exr"));
        }
        EXPECT_FALSE(exists("b.vdb.checkpoint"));
        // The frames are those of the cache, whoever baked it.
        const auto again =
            runWell("render", shot + light + ofRender + " --cache a.vdb -o b.####.exr --resume");
        EXPECT_NE(again.out.find("2 more were done"), std::string::npos) << again.out;
        fs::remove(path("b.vdb"));
    }
}

/// A bake that takes a second or two of a core.
class SlowBake : public BakeAndRender {
protected:
    const std::string kOne = "set.obj --camera camera.json --frames 1 --size 96x54 --threads 1 ";
    const std::string kBake = kOne + "--spacing 0.03 ";
    const std::string kRender = kOne + "--env map.exr --spp 2 --bounces 4 ";
    const std::string kBoth = kRender + "--bake-spacing 0.03 --bake a.vdb -o a.exr ";
};

TEST_F(SlowBake, ShowsAPictureBeforeTheCacheIsThere) {
    auto whole = std::async(std::launch::async, [&] { return run("render", kBoth); });
    const auto isOver = [&] {
        return whole.wait_for(std::chrono::milliseconds(5)) == std::future_status::ready;
    };
    while (!exists("a.exr") && !isOver()) {
    }
    const bool before = !exists("a.vdb");
    const bool preview = isPreview("a.exr");
    const ExrFile first = readExr(path("a.exr"));
    const ProgramRun run = whole.get();
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_TRUE(before) << "the picture came after the cache";
    EXPECT_TRUE(preview);
    EXPECT_EQ(first.metadata.at("shadowcache:camera-rays"), "1");
    EXPECT_FALSE(isPreview("a.exr"));
    EXPECT_NE(run.out.find("a.exr: 1 camera ray a pixel, 0 items baked so far"), std::string::npos)
        << run.out;
    // The control: who waits sees none.
    fs::remove(path("a.vdb"));
    const auto waited = runWell("render", kBoth + "--wait");
    EXPECT_EQ(waited.out.find("baked so far"), std::string::npos) << waited.out;
}

TEST_F(SlowBake, ThatIsStoppedIsContinuedByEitherProgram) {
    const double begin = secondsNow();
    runWell("bake", kBake + "-o whole.vdb");
    const double ofBake = secondsNow() - begin;
    runWell("render", kOne + "--env map.exr --spp 1 --bounces 4 -o whole.exr");
    const double ofFirst = secondsNow() - begin - ofBake;
    runWell("render", kRender + "--cache whole.vdb -o whole.exr");
    for (const std::string& next :
         {"bake " + kBake + "-o a.vdb --resume", "render " + kBoth + "--resume"}) {
        SCOPED_TRACE(next);
        ProgramRun ended;
        for (std::uint64_t turn = 0; turn < 20 && !exists("a.vdb.checkpoint"); ++turn) {
            fs::remove(path("a.vdb"));
            // Others may use the machine: no moment is sure to be in the midst of the bake.
            const double share = turn == 0 ? 0.5 : toUnit(hashWords(5, turn));
            RunLimits limits;
            limits.interruptWhen = afterSeconds(ofFirst + share * ofBake);
            limits.signal = SIGTERM;
            ended = run("render", kBoth, limits);
        }
        ASSERT_TRUE(exists("a.vdb.checkpoint"));
        EXPECT_EQ(ended.status, kTryAgain) << ended.err;
        EXPECT_NE(ended.out.find("--resume continues"), std::string::npos) << ended.out;
        EXPECT_FALSE(exists("a.vdb"));
        for (const std::string& name : files())
            EXPECT_EQ(name.find(".part-"), name.npos) << name << " is left";
        const auto space = next.find(' ');
        const auto resumed = runWell(next.substr(0, space), next.substr(space + 1));
        EXPECT_NE(resumed.out.find("regions are finished"), std::string::npos) << resumed.out;
        EXPECT_TRUE(readBytes(path("a.vdb")) == readBytes(path("whole.vdb")));
        EXPECT_FALSE(exists("a.vdb.checkpoint"));
        if (next.starts_with("bake")) {
            // What is there is used.
            const auto rendered = runWell("render", kBoth);
            EXPECT_NE(rendered.out.find("a.vdb: baked before"), std::string::npos) << rendered.out;
        }
        expectSamePixels("a.exr", "whole.exr");
        fs::remove(path("a.vdb"));
    }
}

TEST_F(BakeAndRender, RefusesACacheOfAnotherShotOrSet) {
    const std::string light = "--env map.exr --spp 1 -o a.####.exr --bake a.vdb ";
    runWell("render", kShot + light);
    expectRefusal(run("render", "set.obj --camera camera.json --frames 1-3 --size 48x32 " + light),
                  "render", "a.vdb: baked for camera.json, frames 1-2, 48x32",
                  "expected camera.json, frames 1-3, 48x32");
    expectRefusal(
        run("render", "other.obj --camera camera.json --frames 1-2 --size 48x32 " + light),
        "render", "a.vdb: baked for", "expected");
    folder_.write("a.vdb", "no cache");
    expectRefusal(run("render", kShot + light), "render", "a.vdb: ");
    EXPECT_EQ(readBytes(path("a.vdb")), "no cache") << "it must not be written over";
    // All of the set has every shot, but not of every set.
    runWell("bake", "set.obj -o a.vdb --spacing 0.25 --level 3");
    EXPECT_NE(runWell("render", kShot + light).out.find("a.vdb: baked before"), std::string::npos);
    runWell("bake", "other.obj -o a.vdb --spacing 0.25 --level 3");
    expectRefusal(run("render", kShot + light), "render", "a.vdb: baked for another set");
}

TEST_F(BakeAndRender, ExplainsWhatTheBakeIsWorth) {
    const std::string asked = kShot + std::string("--env map.exr -o a.####.exr --bake a.vdb ");
    for (const char* more : {"", "--lamps off --estimator cache"}) {
        const auto told = runWell("render", asked + "--spp 8 --explain " + more);
        for (const char* words : {"bake        ", "frame       ", "worth       "})
            EXPECT_NE(told.out.find(words), std::string::npos) << told.out;
    }
    EXPECT_FALSE(exists("a.vdb"));
    EXPECT_FALSE(exists("a.0001.exr"));
    runWell("render", asked + "--spp 8 --explain --stats worth.json");
    const std::string written = readBytes(path("worth.json"));
    for (const char* of : {"\"bake\"", "\"frame\"", "\"frame_without\""})
        EXPECT_NE(written.find(of), std::string::npos) << written;
    expectRefusal(run("render", asked + "--explain --samples 0 --camera-rays 1"), "render",
                  "--preview", "unbiased");
}

TEST_F(BakeAndRender, RefusesOptionsByName) {
    const std::string still = "set.obj --env map.exr --size 12x8 -o a.exr ";
    struct Refusal {
        std::string arguments, option;
    };
    for (const Refusal& each :
         {Refusal{"--eye 1,1,1 --look-at 0,0,0 --bake a.vdb", "--eye"},
          Refusal{"--camera camera.json --bake a.vdb --cache b.vdb", "--cache"},
          Refusal{"--camera camera.json --wait", "--wait requires --bake"},
          Refusal{"--camera camera.json --bake-quality good", "--bake-quality requires --bake"},
          Refusal{"--camera camera.json --bake a.vdb --bake-quality best", "--bake-quality best"},
          Refusal{"--camera camera.json --bake-spacing 1", "--bake-spacing requires --bake"},
          Refusal{"--camera camera.json --bake a.vdb --bake-spacing 1 --bake-quality good",
                  "--bake-quality"},
          Refusal{"--camera camera.json --preview", "--preview requires --cache or --bake"},
          Refusal{"--camera camera.json --memory 1G", "--memory requires --cache or --bake"}}) {
        const auto refused = run("render", still + each.arguments);
        EXPECT_EQ(refused.status, kWrongUsage) << each.arguments;
        EXPECT_NE(refused.err.find(each.option), std::string::npos) << refused.err;
    }
    const std::string view = still + "--camera camera.json ";
    expectRefusal(run("render", view + "--bake a.exr"), "render", "a.exr", ".vdb");
    expectRefusal(run("render", "set.obj --size 12x8 -o a.exr --camera camera.json --bake a.vdb"),
                  "render", "--env: expected a map or a radiance");
    EXPECT_FALSE(exists("a.vdb"));
    const auto extended = run("bake", "set.obj -o a.vdb --extend a.vdb --quality fine");
    EXPECT_EQ(extended.status, kWrongUsage);
    EXPECT_NE(extended.err.find("--quality cannot be combined with --extend"), std::string::npos)
        << extended.err;
}

}  // namespace
}  // namespace shadowcache::test
