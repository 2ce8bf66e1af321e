// The plan of a farm word by word; texts of its schedulers; words of a shell are what they were.

#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/farm/farm_files.h"
#include "common/farm/plan.h"
#include "common/farm/shell.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache {
namespace {

using Words = std::vector<std::string>;

FarmPlan planOf(int shards) {
    FarmJob job;
    job.set = {"a set.ply", "--camera", "cam.json"};
    job.bakeOnly = {"--rays", "8"};
    job.renderOnly = {"--env", "sky.exr"};
    job.frames = {1, 2, 3, 4, 5};
    job.shards = shards;
    job.chunk = 2;
    FarmPlan place;
    place.folder = "/j";
    place.work = "/w";
    place.programs = "/p";
    place.threads = 3;
    return makePlan(job, place);
}

/// A task's command line in one text.
std::string lineOf(const FarmStep& step, std::size_t task) {
    std::string line = step.program;
    for (const std::string& word : step.argumentsOf(task)) line += " " + shellWord(word);
    return line;
}

TEST(FarmPlan, BakesMergesRendersChecks) {
    const FarmPlan plan = planOf(2);
    ASSERT_EQ(plan.steps.size(), 5u);
    const std::string set = "'a set.ply' --camera cam.json ",
                      running = " --threads 3 --progress lines";
    EXPECT_EQ(lineOf(plan.steps[0], 0),
              "shadowcache-bake " + set +
                  "--rays 8 --frames 1-5 --lookups-only -o /j/shot.lookups" + running);
    EXPECT_EQ(plan.steps[0].values.size(), 1u);
    EXPECT_EQ(plan.steps[0].product.with("1"), "/j/shot.lookups");
    EXPECT_EQ(lineOf(plan.steps[1], 1), "shadowcache-bake " + set +
                                            "--rays 8 --frames 1-5 --lookups /j/shot.lookups "
                                            "--shard 2/2 -o /j/parts/2.vdb --resume" +
                                            running);
    EXPECT_EQ(plan.steps[1].values.size(), 2u);
    EXPECT_EQ(plan.steps[1].product.with("2"), "/j/parts/2.vdb");
    EXPECT_EQ(lineOf(plan.steps[2], 0),
              "shadowcache-merge /j/parts/1.vdb /j/parts/2.vdb -o /j/cache.vdb --progress lines");
    const std::string shot =
        "shadowcache-render " + set + "--env sky.exr --cache /j/cache.vdb --frames ";
    EXPECT_EQ(plan.steps[3].values, (Words{"1-2", "3-4", "5"}));
    EXPECT_EQ(lineOf(plan.steps[3], 2),
              shot + "5 -o '/j/frames/frame.####.exr' --shot-frames 1-5 --resume" + running);
    EXPECT_EQ(lineOf(plan.steps[4], 0), shot + "1-5 -o '/j/frames/frame.####.exr' --check");
}

TEST(FarmPlan, OfOneShardMakesTheCacheAtOnce) {
    const FarmPlan plan = planOf(1);
    ASSERT_EQ(plan.steps.size(), 3u);
    EXPECT_EQ(lineOf(plan.steps[0], 0),
              "shadowcache-bake 'a set.ply' --camera cam.json --rays 8 --frames 1-5 -o "
              "/j/cache.vdb --resume "
              "--threads 3 --progress lines");
    EXPECT_EQ(plan.steps[1].name, "render");
}

TEST(FarmPlan, RefusesWhatIsOutOfRange) {
    EXPECT_THROW(planOf(0), Error);
    EXPECT_THROW(planOf(kMostShards + 1), Error);
    EXPECT_EQ(planOf(kMostShards).steps[1].values.size(), std::size_t{kMostShards});
}

TEST(FarmPlan, FramesReadBackAsTheyWere) {
    EXPECT_EQ(framesText({7}), "7");
    EXPECT_EQ(framesText({1, 2, 3}), "1-3");
    EXPECT_EQ(framesText({1, 3, 5}), "1-5x2");
    EXPECT_EQ(framesText({1, 2, 4}), "1,2,4");
    EXPECT_EQ(framesText({4, 3}), "4,3");
}

TEST(FarmShell, WordsAreWhatTheyWere) {
    const test::TemporaryFolder folder;
    for (const std::string& word :
         {std::string("plain-1_2.exr"), std::string("a b"), std::string("it's"), std::string(""),
          std::string("$HOME `ls` \"q\" \\ * ? [a] {b,c} ~ # & ; | < > ( ) !"),
          std::string("line\nline"), std::string("ü ####.exr"), std::string("-o"), std::string("~"),
          std::string("a=b")}) {
        const std::string command = "printf %s " + shellWord(word) + " > '" +
                                    (folder.path() / "word").string() + "'; printf . >> '" +
                                    (folder.path() / "word").string() + "'";
        folder.write("script", command);
        ASSERT_EQ(std::system(("bash '" + (folder.path() / "script").string() + "'").c_str()), 0);
        EXPECT_EQ(readFileBytes(folder.path() / "word"), word + ".");
    }
    EXPECT_EQ(shellWord("plain-1_2.exr"), "plain-1_2.exr");
}

/// The only file of a scheduler, or that of this name.
std::string fileOf(const std::vector<FarmFile>& files, const std::string& name) {
    for (const FarmFile& file : files)
        if (file.name == name) return file.text;
    ADD_FAILURE() << "no " << name;
    return "";
}

TEST(FarmFiles, SlurmWaitsForSuccessAndRequeues) {
    const auto files = slurmFiles(planOf(2));
    const std::string submit = fileOf(files, "submit"), task = fileOf(files, "slurm-task");
    const char* const steps =
        "submit lookup --output=log/lookup.log \"$@\"\nsubmit bake --output=log/bake.%a.log "
        "--array=1-2 \"$@\"\nsubmit merge "
        "--output=log/merge.log "
        "\"$@\"\nsubmit render --output=log/render.%a.log --array=1-3 \"$@\"\nsubmit check";
    for (const char* part : {"--requeue", "--kill-on-invalid-dep=yes", "--cpus-per-task=3",
                             "--dependency=\"afterok:$id\"", steps})
        EXPECT_NE(submit.find(part), std::string::npos) << part << " in:\n" << submit;
    EXPECT_NE(task.find("$status -eq 75"), std::string::npos) << task;
    EXPECT_NE(task.find("scontrol requeue"), std::string::npos) << task;
    FarmPlan whole = planOf(2);
    whole.threads = 0;
    EXPECT_NE(fileOf(slurmFiles(whole), "submit").find("--exclusive"), std::string::npos);
}

// Names and types of "Template Schemas [Version: 2023-09]".
TEST(FarmFiles, OpenJdTemplateHasItsForm) {
    const auto json = nlohmann::json::parse(fileOf(openjdFiles(planOf(2)), "openjd.json"));
    EXPECT_EQ(json.at("specificationVersion"), "jobtemplate-2023-09");
    const auto& folder = json.at("parameterDefinitions").at(0);
    EXPECT_EQ(folder.at("type"), "PATH");
    EXPECT_EQ(folder.at("default"), ".") << "a default must be relative";
    ASSERT_EQ(json.at("steps").size(), 5u);
    const auto& render = json.at("steps").at(3);
    EXPECT_EQ(render.at("dependencies"), nlohmann::json::parse(R"([{"dependsOn": "merge"}])"));
    EXPECT_EQ(
        render.at("parameterSpace"),
        nlohmann::json::parse(
            R"({"taskParameterDefinitions": [{"name": "Task", "type": "INT", "range": "1-3"}]})"));
    EXPECT_EQ(render.at("script").at("actions").at("onRun").at("args"),
              nlohmann::json::parse(R"(["again", "render", "{{Task.Param.Task}}"])"));
    EXPECT_EQ(json.at("steps").at(1).at("dependencies"),
              nlohmann::json::parse(R"([{"dependsOn": "lookup"}])"));
    EXPECT_FALSE(json.at("steps").at(0).contains("dependencies"));
}

TEST(FarmFiles, SnakemakeRulesFollowEachOther) {
    const std::string text = fileOf(snakemakeFiles(planOf(2)), "Snakefile");
    EXPECT_NE(text.find("shell: \"./run again check {wildcards.task} >"), std::string::npos)
        << text;
    EXPECT_NE(text.find("rule check:\n    input: expand(\"done/render.{task}\", task=range(1, 4))\n"
                        "    output: touch(\"done/check.{task}\")\n"),
              std::string::npos)
        << text;
}

}  // namespace
}  // namespace shadowcache
