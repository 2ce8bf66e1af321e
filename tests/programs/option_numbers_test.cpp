// Every option of every program that holds a number, with numbers at the ends of all types. What
// options there are is what --help says, so that a new one is tested, too, or fails the test.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/cli_fixture.h"
#include "tests/support/extreme_numbers.h"
#include "tests/support/option_forms.h"

namespace shadowcache::test {
namespace {

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
    for (const auto& [option, forms] :
         formsOf(subject, run(subject.program, helpOf(subject)).out)) {
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
    return fmt::format("{}{}", test.param.subject.program, test.param.number);
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
