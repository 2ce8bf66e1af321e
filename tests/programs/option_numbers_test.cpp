// Every option of every program that holds a number, with numbers at the ends of all types. What
// options there are is what --help says, so that a new one is tested, too, or fails the test.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/cli_fixture.h"
#include "tests/support/extreme_numbers.h"

namespace shadowcache::test {
namespace {

/// A program, a command line that runs, and its options whose text holds numbers: '@' is one.
struct Subject {
    std::string program;
    std::string arguments;
    std::map<std::string, std::vector<std::string>> forms;
    std::map<std::string, std::string> needs{};  ///< arguments to add beside an option
    int parts = 1;                               ///< tests that its options are divided among
};

/// Options that hold no number.
const std::set<std::string>& wordOptions() {
    static const std::set<std::string> words{
        "--up",           "--env",      "--dynamic",     "--normals",   "--camera",
        "--filter",       "--budget",   "--sequence",    "--estimator", "--cache",
        "--output",       "--aov",      "--reference",   "--stats",     "--config",
        "--write-config", "--progress", "--convolution", "--extend",    "--report",
        "--bake-with",    "--for",      "--pictures",    "--surfaces",  "--lookups"};
    return words;
}

std::vector<Subject> subjects() {
    const std::string view = "--env 1,1,1 --samples 1 --size 6x4 -o new.exr ";
    const std::string still = "--eye 1,1.5,2 --look-at 0,0.3,0 ";
    return {
        {"render",
         "set.obj " + view + still,
         {{"--env", {"@,1,1", "1,1,@"}},
          {"--env-rotate", {"@", "0-@", "@-1"}},
          {"--frames", {"@", "1-@", "1-9x@"}},
          {"--eye", {"@,1,2", "1,1,@", "@,@,@"}},
          {"--look-at", {"@,0,0", "0,0,@"}},
          {"--size", {"@x4", "6x@", "@x@"}},
          {"--crop", {"@,0,2x2", "0,@,2x2", "0,0,@x2", "0,0,2x@"}},
          {"--albedo", {"@", "@,0,0"}},
          {"--pixel-map", {"@x4", "8x@"}},
          {"--memory", {"@", "@G"}},
          {"--debug", {"@,0", "0,@"}}},
         {{"--memory", "--cache set.vdb"}, {"--time-limit", "--progressive"}},
         4},
        {"bake",
         "set.obj -o new.vdb --spacing 0.5 --level 1 --rays 1",
         {{"--shard", {"@/2", "1/@", "@/@"}},
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

/// The forms in which a program's options hold numbers, by option.
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

/// A subject and which part of its options.
struct Part {
    Subject subject;
    int number;
};

std::vector<Part> parts() {
    std::vector<Part> all;
    for (const Subject& subject : subjects())
        for (int i = 0; i < subject.parts; ++i) all.push_back({subject, i});
    return all;
}

/// Other things that a refusal may name: what the option acts on.
const std::map<std::string, std::vector<std::string>>& actsOn() {
    static const std::map<std::string, std::vector<std::string>> names{
        {"--eye", {"camera"}},
        {"--look-at", {"camera"}},
        {"--scale", {"spacing", "voxels"}},
        {"--env", {"without a finite estimate"}},
        {"--frames", {"frame "}}};
    return names;
}

class OptionNumbers : public CliTest, public testing::WithParamInterface<Part> {};

/// A run is done, or refused in one line that names the option.
void expectSound(const ProgramRun& result, const std::string& program, const std::string& option) {
    if (result.status == kDone) return;
    EXPECT_TRUE(result.status == kFailed || result.status == kWrongUsage) << result.status;
    const auto lines = std::count(result.err.begin(), result.err.end(), '\n');
    EXPECT_EQ(lines, result.status == kWrongUsage ? 2 : 1) << result.err;
    EXPECT_TRUE(result.err.starts_with("shadowcache-" + program + ": ")) << result.err;
    std::vector<std::string> names{option.substr(2)};
    if (const auto more = actsOn().find(option); more != actsOn().end())
        names.insert(names.end(), more->second.begin(), more->second.end());
    EXPECT_TRUE(std::ranges::any_of(names, [&](const std::string& name) {
        return result.err.find(name) != result.err.npos;
    })) << result.err;
}

TEST_P(OptionNumbers, AreInRangeOrRefused) {
    const auto& [subject, part] = GetParam();
    bake("--rays 1");
    int tried = 0, done = 0, options = 0;
    for (const auto& [option, forms] : formsOf(subject, run(subject.program, "--help").out)) {
        if (options++ % subject.parts != part) continue;
        for (const std::string& form : forms)
            for (const std::string& number : extremeNumbers()) {
                // One form of an option meets all numbers, the others every third.
                if (&form != &forms[0] && (&number - extremeNumbers().data()) % 3 != 0) continue;
                const std::string value = std::regex_replace(form, std::regex("@"), number);
                const auto needs = subject.needs.find(option);
                const std::string arguments = subject.arguments + " " +
                                              (needs == subject.needs.end() ? "" : needs->second) +
                                              " " + option + "=" + value;
                SCOPED_TRACE(subject.program + " " + arguments);
                const ProgramRun result = run(subject.program, arguments);
                expectSound(result, subject.program, option);
                ++tried;
                done += result.status == kDone ? 1 : 0;
                std::filesystem::remove_all(path("job"));
            }
    }
    std::printf("%s: %d of %d runs were done\n", subject.program.c_str(), done, tried);
    EXPECT_TRUE(tried > 100 || subject.program == "merge") << tried;
}

INSTANTIATE_TEST_SUITE_P(Programs, OptionNumbers, testing::ValuesIn(parts()), [](const auto& test) {
    return test.param.subject.program + std::to_string(test.param.number);
});

/// Words longer than any parser's stack.
TEST_F(CliTest, LongWordsAreRefused) {
    bake("--rays 1");
    const std::string many(120000, '1');
    const std::vector<std::pair<std::string, std::string>> cases{
        {"render", still("-o new.exr --samples ") + many},
        {"render", still("-o new.exr --up ") + many},
        {"render", still("-o new.exr --env ") + many},
        {"render", still("-o new.exr --env-rotate ") + many},
        {"render", still("-o new.exr --crop ") + many},
        {"render", still("-o new.exr --") + many},
        {"bake", "set.obj -o new.vdb --shard " + many},
        {"bake", "set.obj -o new.vdb --camera camera.json --frames " + many},
        {"info", "set.vdb -o new.vdb --export-grid " + many},
        {"info", "set.vdb --at " + many}};
    for (const auto& [program, arguments] : cases) {
        const ProgramRun result = run(program, arguments);
        EXPECT_TRUE(result.status == kFailed || result.status == kWrongUsage)
            << program << " " << arguments.substr(0, 80) << ": " << result.status;
    }
}

}  // namespace
}  // namespace shadowcache::test
