#include "tests/support/option_forms.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>

namespace shadowcache::test {
namespace {

/// Options that hold no number.
const std::set<std::string>& wordOptions() {
    static const std::set<std::string> words{
        "--up",           "--env",       "--dynamic",     "--normals",   "--camera",
        "--filter",       "--budget",    "--sequence",    "--estimator", "--cache",
        "--output",       "--aov",       "--reference",   "--stats",     "--config",
        "--write-config", "--progress",  "--extend",      "--report",    "--bake-with",
        "--for",          "--pictures",  "--surfaces",    "--lamps",     "--lookups",
        "--lamp",         "--aov-names", "--quality",     "--bake",      "--bake-quality",
        "--mix",          "--gain",      "--light-groups"};
    return words;
}

}  // namespace

std::vector<Subject> subjects() {
    const std::string view = "--env 1,1,1 --samples 1 --size 6x4 -o new.exr ";
    const std::string still = "--eye 1,1.5,2 --look-at 0,0.3,0 ";
    return {
        {"render",
         "set.obj " + view + still,
         {{"--env", {"@,1,1", "1,1,@"}},
          {"--env-rotate", {"@", "0-@", "@-1", "@,0,0", "0,0,@"}},
          {"--env-gain", {"@", "1,1,@"}},
          {"--frames", {"@", "1-@", "1-9x@"}},
          {"--shot-frames", {"@", "1-@"}},
          {"--eye", {"@,1,2", "1,1,@", "@,@,@"}},
          {"--look-at", {"@,0,0", "0,0,@"}},
          {"--size", {"@x4", "6x@", "@x@"}},
          {"--crop", {"@,0,2x2", "0,@,2x2", "0,0,@x2", "0,0,2x@"}},
          {"--albedo", {"@", "@,0,0"}},
          {"--memory", {"@", "@G"}},
          {"--debug", {"@,0", "0,@"}}},
         {{"--memory", "--cache set.vdb"}, {"--time-limit", "--progressive"}},
         4},
        {"bake",
         "set.obj -o new.vdb --spacing 0.5 --level 1 --rays 1",
         {{"--spacing", {"@", "@x"}},
          {"--shard", {"@/2", "1/@", "@/@"}},
          {"--memory", {"@", "@G"}},
          {"--frames", {"@", "1-@"}},
          {"--size", {"@x4", "6x@"}}},
         {{"--frames", "--camera camera.json --size 6x4"},
          {"--size", "--camera camera.json"},
          {"--margin", "--camera camera.json --size 6x4"},
          {"--fps", "--camera camera.json --size 6x4"}}},
        {"info",
         "set.vdb",
         {{"--at", {"@,0,0,0,1,0", "0,0,@,0,1,0", "0,0,0,@,0,0", "0,0,0,0,1,@"}},
          {"--export-grid", {"direction=@,1,0", "direction=0,0,@"}}},
         {{"--export-grid", "-o new.vdb"}, {"--env-rotate", "--export-grid openness -o new.vdb"}}},
        {"merge", "set.vdb -o new.vdb", {}},
        {"farm",
         "set.obj --camera camera.json --frames 1-3 --for parallel -o job",
         {{"--frames", {"@", "1-@"}}, {"--size", {"@x4", "6x@"}}}},
    };
}

std::string helpOf(const Subject& subject) {
    return subject.program == "render" ? "--help-all" : "--help";
}

std::map<std::string, std::vector<std::string>> formsOf(const Subject& subject,
                                                        const std::string& help) {
    auto forms = subject.forms;
    std::istringstream lines(help);
    static const std::regex option(R"(^  (?:-\w,)?(--[\w-]+) ([A-Z]+).*)");
    for (std::string line; std::getline(lines, line);) {
        std::smatch match;
        if (!std::regex_match(line, match, option)) continue;
        const std::string name = match[1], type = match[2];
        if (forms.contains(name)) continue;
        const bool number = type != "TEXT" && type != "NAME" && type != "SPEC";
        if (number) forms[name] = {"@"};
        EXPECT_TRUE(number || wordOptions().contains(name))
            << subject.program << " " << name << ": say whether it holds numbers";
    }
    return forms;
}

}  // namespace shadowcache::test
