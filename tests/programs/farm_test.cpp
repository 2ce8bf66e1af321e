// shadowcache-farm, and the script that it writes, on one machine; tests/farm/run has the
// schedulers.

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>

#include "common/image/exr.h"
#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

class Farm : public CliTest {
protected:
    /// Arguments of a job of five frames in the folder "a job".
    static std::vector<std::string> job(const std::vector<std::string>& more = {}) {
        std::vector<std::string> all{"set.obj",
                                     "--camera",
                                     "camera.json",
                                     "--frames",
                                     "1-5",
                                     "--size",
                                     "12x8",
                                     "--chunk",
                                     "2",
                                     "--for",
                                     "parallel",
                                     "--bake-shards",
                                     "2",
                                     "-o",
                                     "a job",
                                     "--bake-with",
                                     "--spacing 0.25 --level 3"};
        all.insert(all.end(), more.begin(), more.end());
        all.insert(all.end(), {"--", "--env", "map.exr", "--env-rotate", "0-90", "--spp", "4"});
        return all;
    }

    ProgramRun farm(const std::vector<std::string>& arguments) const {
        return runProgram("farm", arguments, folder_.path());
    }

    /// Puts a script in place of shadowcache-bake; the file "runs" has a byte for each of its runs.
    void replaceBake(const std::string& script) const {
        std::filesystem::create_directory(path("bin"));
        std::filesystem::remove(path("runs"));
        folder_.write("bin/shadowcache-bake", "#!/bin/sh\nprintf x >> runs\n" + script + "\n");
        std::filesystem::permissions(path("bin/shadowcache-bake"), std::filesystem::perms::all);
    }

    /// Exit status of a line of a shell in the folder, whose PATH has the programs.
    int shell(const std::string& line) const {
        folder_.write("line.bash", line);
        const int status =
            std::system(("cd '" + folder_.path().string() + "' && PATH=" + programFolders() +
                         ":$PATH SHADOWCACHE_BIN=$PWD/bin bash line.bash > line.out 2> line.err")
                            .c_str());
        return WEXITSTATUS(status);
    }

    std::string output() const { return readBytes(path("line.out")) + readBytes(path("line.err")); }
};

/// The programs of a build stand in several folders, of which the job knows.
TEST_F(Farm, FindsThePrograms) {
    EXPECT_EQ(farm(job()).err, "");
    folder_.write("line.bash", "env -i PATH=/usr/bin:/bin bash 'a job/run' lookup");
    const std::string line =
        "cd '" + folder_.path().string() + "' && bash line.bash > line.out 2>&1";
    EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), kDone) << readBytes(path("line.out"));
}

/// One that stands alone says what its job will look for.
TEST_F(Farm, SaysWhichProgramsAreMissing) {
    std::filesystem::create_directory(path("alone"));
    std::filesystem::copy_file(programPath("farm"), path("alone/shadowcache-farm"));
    std::string line = "cd '" + folder_.path().string() + "' && alone/shadowcache-farm";
    for (const std::string& word : job()) line += " '" + word + "'";
    EXPECT_EQ(WEXITSTATUS(std::system((line + " 2> line.err").c_str())), kDone);
    for (const char* name : {"bake", "merge", "render"})
        EXPECT_NE(readBytes(path("line.err"))
                      .find(std::string("warning: shadowcache-") + name + ": not in"),
                  std::string::npos)
            << readBytes(path("line.err"));
}

TEST_F(Farm, RunsToTheFramesOfOneMachine) {
    const ProgramRun written = farm(job());
    EXPECT_EQ(written.status, kDone) << written.err;
    EXPECT_EQ(written.out,
              "lookup: 1 task\nbake: 2 tasks\nmerge: 1 task\nrender: 3 tasks\ncheck: 1 task\n"
              "-> a job: submit [OPTIONS of parallel]\n");
    const std::string run = "'a job/run' ";
    EXPECT_EQ(shell(run + "check"), kFailed) << "there is no cache yet";
    EXPECT_EQ(shell(run + "bake 1"), kFailed) << "what the shot looks up is not yet known";
    EXPECT_EQ(shell(run + "lookup && " + run + "bake 1 && " + run + "bake 2 && " + run + "merge"),
              kDone)
        << output();
    EXPECT_EQ(shell(run + "render 1 && " + run + "again render 2"), kDone) << output();
    EXPECT_EQ(shell(run + "check"), kFailed);
    EXPECT_NE(output().find("frame.0005.exr: missing\n"), std::string::npos) << output();
    EXPECT_EQ(shell(run + "render 3 && " + run + "check"), kDone) << output();
    EXPECT_NE(output().find("5 frames, all done"), std::string::npos) << output();

    bake("--camera camera.json --frames 1-5 --size 12x8");
    runWell("render",
            "set.obj --env map.exr --env-rotate 0-90 --spp 4 --camera camera.json --size 12x8 "
            "--frames 1-5 --bounces 4 "
            "--cache set.vdb -o f.#.exr");
    for (int frame = 1; frame <= 5; ++frame) {
        const ExrFile one = readExr(path(fmt::format("f.{}.exr", frame)));
        const ExrFile other = readExr(path(fmt::format("a job/frames/frame.000{}.exr", frame)));
        ASSERT_EQ(one.channels.size(), other.channels.size());
        for (std::size_t k = 0; k < one.channels.size(); ++k)
            EXPECT_EQ(one.channels[k].values, other.channels[k].values) << frame;
    }

    // What is done is not done again.
    EXPECT_EQ(shell(run + "bake 1 && " + run + "merge && " + run + "render 1"), kDone);
    EXPECT_NE(output().find("a job/parts/1.vdb: done\n"), std::string::npos) << output();
    EXPECT_NE(output().find("a job/cache.vdb: done\n"), std::string::npos) << output();
    EXPECT_NE(output().find("0 frames (2 more were done)"), std::string::npos) << output();
    EXPECT_EQ(output().find("set: "), std::string::npos) << "the set was read";

    // Unless what it was made of is newer.
    std::filesystem::last_write_time(path("camera.json"),
                                     std::filesystem::file_time_type::clock::now());
    EXPECT_EQ(shell(run + "lookup && " + run + "bake 1"), kDone);
    EXPECT_EQ(output().find(": done\n"), std::string::npos) << output();
}

TEST_F(Farm, TasksThatDoNotExistAreWrongUsage) {
    ASSERT_EQ(farm(job()).status, kDone);
    for (const char* task : {"", "bake 3", "bake 0", "bake x", "render 4", "paint 1"}) {
        EXPECT_EQ(shell(std::string("'a job/run' ") + task), kWrongUsage) << task;
        EXPECT_NE(output().find("run bake TASK    (1 to 2)\n"), std::string::npos) << output();
    }
}

TEST_F(Farm, TriesAgainWhatWasInterruptedAndNothingElse) {
    ASSERT_EQ(farm(job()).status, kDone);
    const auto runs = [&](const std::string& status) {
        replaceBake("exit " + status);
        EXPECT_EQ(shell("'a job/run' again bake 1"), std::stoi(status)) << output();
        return readBytes(path("runs")).size();
    };
    EXPECT_EQ(runs("0"), 1u);
    EXPECT_EQ(runs("1"), 1u);
    EXPECT_EQ(runs("2"), 1u);
    EXPECT_EQ(runs("75"), 3u);
}

TEST_F(Farm, PassesSignalsOnAndTriesNotAgain) {
    ASSERT_EQ(farm(job()).status, kDone);
    replaceBake("trap 'exit 75' TERM; touch ready; while :; do sleep 0.05; done");
    EXPECT_EQ(shell("'a job/run' again bake 1 & id=$!\n"
                    "until [ -e ready ]; do sleep 0.05; done\n"
                    "kill -TERM $id; wait $id"),
              kTryAgain)
        << output();
    EXPECT_EQ(readBytes(path("runs")).size(), 1u);
}

TEST_F(Farm, RefusesWhatItCannotPlan) {
    const auto refuses = [&](const std::vector<std::string>& arguments, const std::string& first) {
        const auto before = files();
        expectRefusal(farm(arguments), "farm", first);
        EXPECT_EQ(files(), before);
    };
    refuses(job({"--bake-shards", "0"}), "--bake-shards 0: expected 1 to 10000");
    refuses(job({"--chunk", "0"}), "--chunk 0: expected 1 to");
    refuses(job({"--frames", "5-1"}), "--frames 5-1: expected");
    refuses(job({"--size", "12"}), "--size 12: expected");
    refuses(job({"--pictures", "a.exr"}), "expected a frame number in the name");
    refuses(job({"--bake-with", "--rays 5 --output x"}), "--output: set by shadowcache-farm");
    refuses(job({"--bake-with", "--lookups x"}), "--lookups: set by shadowcache-farm");
    refuses(job({"--bake-with", "--shard 1/2"}), "--shard: set by shadowcache-farm");
    auto twice = job();
    twice.insert(twice.end(), {"--frames", "1"});
    refuses(twice, "-- --frames: set by shadowcache-farm");
    auto bakes = job();
    bakes.insert(bakes.end(), {"--bake", "a.vdb"});
    refuses(bakes, "-- --bake: set by shadowcache-farm");
    EXPECT_EQ(farm(job({"--for", "cron"})).status, kWrongUsage);
    ASSERT_EQ(farm(job()).status, kDone);
    refuses(job({"--chunk", "3"}), "a job/run: of another job, expected an empty folder");
    EXPECT_EQ(farm(job({"--for", "slurm"})).status, kDone) << "the same job, elsewhere";
}

}  // namespace
}  // namespace shadowcache::test
