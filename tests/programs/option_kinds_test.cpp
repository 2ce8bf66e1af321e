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

/// The control.
TEST_F(OptionKinds, ANewOptionIsNoticed) {
    const std::string help = runWell("bake", "--help").out;
    EXPECT_NONFATAL_FAILURE(formsOf(subjects()[1], help + "  --new TEXT   Something new\n"),
                            "bake --new: say whether it holds numbers");
}

}  // namespace
}  // namespace shadowcache::test
