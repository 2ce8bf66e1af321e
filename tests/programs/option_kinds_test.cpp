// Every option of every program is known to option_numbers_test: that test is long and runs late,
// and a new option should be noticed by the next test run.

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include "tests/support/cli_fixture.h"
#include "tests/support/option_forms.h"

namespace shadowcache::test {
namespace {

using OptionKinds = CliTest;

TEST_F(OptionKinds, AreSaidForAllOptions) {
    for (const Subject& subject : subjects())
        formsOf(subject, runWell(subject.program, helpOf(subject)).out);
}

/// Rows of a table as `--options` prints it that a door has.
std::string rowsAt(const std::string& door, const std::string& table) {
    std::istringstream lines(table);
    std::string rows;
    for (std::string line; std::getline(lines, line);) {
        if (line.find("\"" + door + "\": ") == line.npos) continue;
        if (line.ends_with(',')) line.pop_back();
        rows += (rows.empty() ? "[\n" : ",\n") + line;
    }
    return rows + "\n]\n";
}

TEST_F(OptionKinds, BlenderHasItsRowsOfTheTable) {
    const auto file = std::filesystem::path(SHADOWCACHE_SCENES).parent_path() /
                      "render/blender/option_table.json";
    EXPECT_EQ(readBytes(file), rowsAt("blender", runWell("render", "--options").out)) << file;
}

/// The control.
TEST_F(OptionKinds, ANewOptionIsNoticed) {
    const std::string help = runWell("bake", "--help").out;
    EXPECT_NONFATAL_FAILURE(formsOf(subjects()[1], help + "  --new TEXT   Something new\n"),
                            "bake --new: say whether it holds numbers");
}

}  // namespace
}  // namespace shadowcache::test
