// A bake that is killed, interrupted or out of disk loses nothing but its last moments.

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "common/base/process.h"
#include "common/random/sequence.h"
#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

namespace fs = std::filesystem;

/// Kills in all; SHADOWCACHE_KILLS asks for more of them.
int kills() {
    const char* wanted = std::getenv("SHADOWCACHE_KILLS");
    return wanted ? std::atoi(wanted) : 12;
}

class CheckpointTest : public CliTest {
protected:
    /// A bake of about half a second that leaves a checkpoint every hundredth of one.
    static std::string bakeTo(const std::string& output, const std::string& options = "") {
        return "set.obj -o " + output + " --spacing 0.05 --level 5 --threads 1 --checkpoint 0.01 " +
               options;
    }

    bool hasRegions(const std::string& output) const {
        const fs::path folder = path(output + ".checkpoint");
        if (!fs::exists(folder)) return false;
        const std::vector<std::string> names = filesIn(folder);
        return std::ranges::any_of(
            names, [](const std::string& name) { return name.ends_with(".regions"); });
    }

    /// Seconds that a run takes.
    template <class Run>
    static double secondsOf(const Run& run) {
        const double begin = secondsNow();
        run();
        return secondsNow() - begin;
    }

    /// Kills a bake once it has left a checkpoint.
    void leaveCheckpoint(const std::string& output, const std::string& options = "") const {
        double seconds = 0.05;
        for (int turn = 0; turn < 60 && !hasRegions(output); ++turn, seconds *= 1.1) {
            fs::remove(path(output));
            runAndKill("bake", words(bakeTo(output, options)), folder_.path(), seconds);
        }
        ASSERT_TRUE(hasRegions(output));
    }

    /// Kills a bake with --resume at random moments, then lets it end: its bytes are those of the
    /// bake that nobody killed, and nothing is left beside it.
    void killAndCompare(int count, const std::string& options) const {
        const double seconds = secondsOf([&] { runWell("bake", bakeTo("whole.vdb", options)); });
        const std::string whole = readBytes(path("whole.vdb"));
        const std::string command = bakeTo("killed.vdb", options + " --resume");
        fs::remove(path("killed.vdb"));
        int killed = 0, ended = 0;
        for (std::uint64_t turn = 0; killed < count; ++turn) {
            ASSERT_LT(turn, static_cast<std::uint64_t>(100 * count)) << "it always ends first";
            if (runAndKill("bake", words(command), folder_.path(),
                           seconds * toUnit(hashWords(3, turn)))) {
                ++killed;
                if (fs::exists(path("killed.vdb"))) {
                    EXPECT_TRUE(readBytes(path("killed.vdb")) == whole);
                }
            } else {
                ++ended;
                EXPECT_TRUE(readBytes(path("killed.vdb")) == whole)
                    << "after " << killed << " kills";
                fs::remove(path("killed.vdb"));
            }
        }
        runWell("bake", command);
        EXPECT_TRUE(readBytes(path("killed.vdb")) == whole);
        RecordProperty("ended", ended);
        for (const std::string& name : files())
            EXPECT_FALSE(name.starts_with("killed.vdb.")) << name << " is left";
    }
};

TEST_F(CheckpointTest, KilledAtRandomEndsWithTheSameBytes) {
    killAndCompare(kills(), "");
}

TEST_F(CheckpointTest, OfAShotAShardAndAnExtension) {
    const std::string shot = "--camera camera.json --frames 1-2 --size 48x32";
    killAndCompare(3, shot);
    killAndCompare(3, "--shard 2/3");
    runWell("bake", "set.obj -o old.vdb --spacing 0.05 --level 5 " + shot);
    killAndCompare(3, "--extend old.vdb");
}

TEST_F(CheckpointTest, ContinuesInterruptedWork) {
    runWell("bake", bakeTo("whole.vdb"));
    RunLimits limits;
    limits.interruptWhen = [this] { return hasRegions("set.vdb"); };
    const auto ended = run("bake", bakeTo("set.vdb"), limits);
    ASSERT_NE(ended.status, 0);
    EXPECT_NE(ended.out.find("--resume continues"), std::string::npos) << ended.out << ended.err;
    ASSERT_TRUE(hasRegions("set.vdb"));
    const auto resumed = runWell("bake", bakeTo("set.vdb", "--resume"));
    EXPECT_NE(resumed.out.find("regions are finished"), std::string::npos) << resumed.out;
    EXPECT_TRUE(readBytes(path("set.vdb")) == readBytes(path("whole.vdb")));
    EXPECT_FALSE(fs::exists(path("set.vdb.checkpoint")));
}

/// Few items may stay in memory: the others come back from the disk, whoever left them there.
TEST_F(CheckpointTest, BoundedMemoryMakesTheSameBytes) {
    killAndCompare(3, "--memory 20K");
    runWell("bake", bakeTo("all.vdb"));
    EXPECT_TRUE(readBytes(path("whole.vdb")) == readBytes(path("all.vdb")));
}

/// A copy of the set elsewhere is the same set; other options, or another set, are not.
TEST_F(CheckpointTest, OfAnotherBakeIsRefused) {
    leaveCheckpoint("set.vdb");
    const auto refuse = [&](const std::string& arguments, const std::string& difference) {
        expectRefusal(run("bake", arguments), "bake",
                      "set.vdb.checkpoint: checkpoint of another bake", difference);
    };
    refuse(bakeTo("set.vdb", "--resume --rays 9"), "rays 16, expected 9");
    refuse(bakeTo("set.vdb", "--resume --seed 4"), "seed 1, expected 4");
    refuse(bakeTo("set.vdb", "--resume --shard 1/2"), "shard none, expected 1/2");
    refuse("other.obj" + bakeTo("set.vdb", "--resume").substr(7), "set ");
    ASSERT_TRUE(hasRegions("set.vdb")) << "a refusal must not cost the work";
    fs::create_directory(path("stage"));
    fs::copy_file(path("set.obj"), path("stage/copy.obj"));
    const auto resumed =
        runWell("bake", "stage/copy.obj" + bakeTo("set.vdb", "--resume").substr(7));
    EXPECT_NE(resumed.out.find("regions are finished"), std::string::npos);
}

TEST_F(CheckpointTest, IsDroppedWithoutResumeAndSaysSo) {
    leaveCheckpoint("set.vdb");
    const auto again = runWell("bake", bakeTo("set.vdb"));
    EXPECT_NE(again.out.find("removed what an interrupted bake had left"), std::string::npos)
        << again.out;
    EXPECT_FALSE(fs::exists(path("set.vdb.checkpoint")));
}

TEST_F(CheckpointTest, ThatIsDamagedIsBakedAgain) {
    runWell("bake", bakeTo("whole.vdb"));
    leaveCheckpoint("set.vdb");
    const fs::path folder = path("set.vdb.checkpoint");
    for (const std::string& name : filesIn(folder)) {
        std::string bytes = readBytes(folder / name);
        bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
        std::ofstream(folder / name, std::ios::binary) << bytes;
    }
    const auto resumed = runWell("bake", bakeTo("set.vdb", "--resume"));
    EXPECT_NE(resumed.out.find("damaged, what it holds is baked again"), std::string::npos);
    EXPECT_TRUE(readBytes(path("set.vdb")) == readBytes(path("whole.vdb")));
}

/// Unfinished files of ended runs are removed by name; those of other machines are kept.
TEST_F(CheckpointTest, LeftoversAreFoundAndNamed) {
    char host[256] = "";
    gethostname(host, sizeof host - 1);
    const std::string dead = "set.vdb.part-2147483646-nojob-" + std::string(host);
    const std::string far = "set.vdb.part-12-7.node-9-another.machine";
    folder_.write(dead, "x");
    folder_.write(far, "x");
    const auto baked = runWell("bake", "set.obj -o set.vdb --spacing 0.25 --level 1");
    EXPECT_NE(baked.out.find(dead + ": removed"), std::string::npos) << baked.out;
    EXPECT_NE(baked.out.find(far + ": kept"), std::string::npos) << baked.out;
    EXPECT_FALSE(fs::exists(path(dead)));
    EXPECT_TRUE(fs::exists(path(far)));
    const std::string frame = "a.exr.part-2147483646-nojob-" + std::string(host);
    folder_.write(frame, "x");
    const auto drawn = runWell("render", still("-o a.exr"));
    EXPECT_NE(drawn.out.find(frame + ": removed"), std::string::npos) << drawn.out;
    // What is written beside a program's main output, and what shadowcache-info writes.
    for (const char* name : {"a.json", "a.png", "a.html", "grids.vdb"})
        folder_.write(name + dead.substr(std::string("set.vdb").size()), "x");
    runWell("render", still("-o a.exr --png --stats a.json"));
    runWell("info", "set.vdb --report a.html --export-grid openness -o grids.vdb");
    for (const auto& entry : fs::directory_iterator(path(".")))
        EXPECT_TRUE(entry.path().string().find(".part-2147483646") == std::string::npos)
            << entry.path();
}

}  // namespace
}  // namespace shadowcache::test
