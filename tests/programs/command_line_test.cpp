// What the programs' command lines share: help, suggestions, settings files, manuals, completion;
// and what `shadowcache-render --explain` foresees.

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "common/image/exr.h"
#include "tests/support/cli_fixture.h"
#include "tests/support/needs.h"

namespace shadowcache::test {
namespace {

const std::vector<std::string> kPrograms{"bake", "render", "farm", "info", "merge"};

class CommandLine : public CliTest {
protected:
    void expectMeant(const std::string& program, const std::string& arguments,
                     const std::string& meant) const {
        const ProgramRun result = run(program, arguments);
        EXPECT_EQ(result.status, 2) << arguments;
        EXPECT_NE(result.err.find("no such option, did you mean " + meant + "?"), std::string::npos)
            << arguments << ": " << result.err;
    }

    /// Standard output of a script for bash that succeeds.
    std::string shell(const std::string& script) const {
        folder_.write("script.bash", script);
        const std::string command =
            "cd '" + folder_.path().string() + "' && bash script.bash > shell.out 2> shell.err";
        EXPECT_EQ(std::system(command.c_str()), 0) << readBytes(path("shell.err"));
        return readBytes(path("shell.out"));
    }
};

TEST_F(CommandLine, HelpIsGroupedAndHasExamples) {
    for (const std::string& program : kPrograms) {
        const std::string help = runWell(program, "--help").out;
        for (const std::string& part :
             {"Examples:\n  shadowcache-" + program, std::string("Settings file:\n"),
              std::string("--config"), std::string("--version")})
            EXPECT_NE(help.find(part), std::string::npos) << part << " in:\n" << help;
        EXPECT_EQ(help.find("--man-page"), std::string::npos) << "hidden";
    }
    const std::string help = runWell("render", "--help").out;
    for (const char* group : {"Set and light:", "Camera:", "Quality:", "Output:"})
        EXPECT_NE(help.find(group), std::string::npos) << group;
}

TEST_F(CommandLine, HelpShowsWhatAShotNeedsAndHelpAllEverything) {
    const std::string help = runWell("render", "--help").out;
    const std::string all = runWell("render", "--help-all").out;
    for (const char* option : {"--env ", "--camera ", "--spp ", "--cache ", "--preview "})
        EXPECT_NE(help.find(option), std::string::npos) << option;
    for (const char* option : {"\n  --estimator ", "\n  --sequence ", "\n  --pass-rays "}) {
        EXPECT_EQ(help.find(option), std::string::npos) << option;
        EXPECT_NE(all.find(option), std::string::npos) << option;
    }
    const auto options = [](const std::string& text) {
        std::istringstream lines(text);
        int count = 0;
        for (std::string line; std::getline(lines, line);) count += line.starts_with("  -") ? 1 : 0;
        return count;
    };
    EXPECT_LE(options(help), 30);
    const int more = options(all) - options(help);
    EXPECT_NE(help.find(fmt::format("--help-all shows {} more", more)), std::string::npos);
}

TEST_F(CommandLine, SixtyFourShadowRaysUnlessSaidOtherwise) {
    const std::string view = "set.obj --env map.exr --eye 1,1.5,2 --look-at 0,0.3,0 --size 6x4 ";
    const auto rays = [&](const std::string& options) {
        runWell("render", view + options + " -o a.exr");
        const auto metadata = readExr(path("a.exr")).metadata;
        return metadata.at("shadowcache:camera-rays") + "x" + metadata.at("shadowcache:samples");
    };
    EXPECT_EQ(rays(""), "64x1");
    EXPECT_EQ(rays("--spp 16"), "16x1");
    EXPECT_EQ(rays("--samples 16"), "1x16");
    EXPECT_EQ(rays("--camera-rays 16"), "16x1");
    EXPECT_EQ(rays("--camera-rays 2 --samples 16"), "2x16");
}

TEST_F(CommandLine, NamesTheOptionThatWasMeant) {
    expectMeant("render", still("-o a.exr --sample 4"), "--samples");
    expectMeant("render", still("-o a.exr --estimater mis"), "--estimator");
    expectMeant("render", "set.obj --evn map.exr --eye 1,1,1 --look-at 0,0,0 -o a.exr", "--env");
    expectMeant("bake", "set.obj -o a.vdb --spaceing=0.5", "--spacing");
    expectMeant("bake", "set.obj --ouput a.vdb", "--output");
    expectMeant("info", "set.vdb --exportgrid openness", "--export-grid");
    expectMeant("merge", "a.vdb --outptu b.vdb", "--output");
    // Nothing is near: nothing is guessed.
    const ProgramRun result = run("render", still("-o a.exr --quux 4"));
    EXPECT_NE(result.err.find("--quux: no such option\n"), std::string::npos) << result.err;
    expectRefusal(run("render", still("-o a.exr --estimator msi")), "render", "did you mean mis?");
}

// A farm does not try again what ends with 2; every program has the same form.
TEST_F(CommandLine, WrongUsageEndsWithTwo) {
    for (const std::string program : {"bake", "render", "farm", "info", "merge", "make-set"})
        for (const std::string line :
             {"", "--quux", "a b c --quux=1", "--config none.toml x -o y"}) {
            const ProgramRun result = run(program, line);
            EXPECT_EQ(result.status, kWrongUsage) << program << ' ' << line;
            EXPECT_TRUE(result.err.starts_with("shadowcache-" + program + ": ")) << result.err;
            EXPECT_TRUE(result.err.ends_with("\nRun with --help for more information.\n"));
        }
}

TEST_F(CommandLine, ProgressGoesToStandardErrorInTheFormAsked) {
    const std::string bake = "set.obj -o set.vdb --spacing 0.25 --level 1 --progress ";
    EXPECT_EQ(run("bake", bake + "none").err, "");
    EXPECT_EQ(run("bake", bake + "lines").err, "") << "shorter than ten seconds";
    EXPECT_EQ(run("bake", bake + "bar").err.substr(0, 6), "\rbake:");
    const std::string json = run("bake", bake + "json").err;
    EXPECT_TRUE(json.starts_with("{\"task\":\"bake\",\"done\":")) << json;
    EXPECT_TRUE(json.ends_with(",\"left\":0.0}\n")) << json;
    const std::string frames = run("render", move("--frames 1-2 -o f.#.exr --progress json")).err;
    EXPECT_NE(frames.find("{\"task\":\"frames\",\"done\":2,\"total\":2,"), std::string::npos);
    // It is no setting of the picture.
    EXPECT_NE(runWell("render", move("--frames 1-2 -o f.#.exr --resume")).out.find("2 more were"),
              std::string::npos);
    EXPECT_EQ(run("merge", "set.vdb -o two.vdb --progress json").err.find("{\"task\":\"merge\""),
              0u);
    EXPECT_EQ(run("bake", bake + "dots").status, kWrongUsage);
}

TEST_F(CommandLine, WrongUsageNamesTheProgramAndTheOption) {
    for (const std::string line : {"--samples many", "--seed -1", "--up x"}) {
        const ProgramRun result = run("render", still("-o a.exr " + line));
        EXPECT_EQ(result.status, 2) << line;
        EXPECT_TRUE(result.err.starts_with("shadowcache-render: ")) << result.err;
        EXPECT_NE(result.err.find(line.substr(0, line.find(' '))), std::string::npos) << result.err;
        EXPECT_EQ(std::ranges::count(result.err, '\n'), 2) << "the cause, and --help";
    }
    const std::pair<const char*, const char*> causes[]{
        {"--samples many", "--samples many: expected a whole number"},
        {"--exposure x1", "--exposure x1: expected a number"},
        {"--seed -1", "--seed -1: expected a whole number from 0 to below 2^64"},
        {"--seed 18446744073709551616", "expected a whole number from 0 to below 2^64"},
        {"--up x", "--up x: expected one of y, z"},
        {"--filter gausian", "expected one of box, gaussian, blackman-harris, did you mean"},
        {"--aov depth,norml", "--aov norml: expected one of "},
        {"--spp 4", "--spp cannot be combined with --samples"},
        {"--seed", "--seed: expected a value"},
        {"--png=maybe", "--png maybe: expected true or false"},
        {"--config none.toml", "none.toml: cannot be read"}};
    for (const auto& [line, cause] : causes) {
        const ProgramRun result = run("render", still("-o a.exr " + std::string(line)));
        EXPECT_EQ(result.status, 2) << line;
        EXPECT_NE(result.err.find(cause), std::string::npos) << line << ": " << result.err;
    }
    const ProgramRun missing = run("bake", "set.obj");
    EXPECT_TRUE(missing.err.starts_with("shadowcache-bake: --output")) << missing.err;
}

TEST_F(CommandLine, SettingsFileRepeatsARun) {
    bake("--uniform --write-config bake.toml");
    const std::string uniform = readBytes(path("set.vdb")).substr(57);
    runWell("bake", "--config bake.toml");
    EXPECT_EQ(readBytes(path("set.vdb")).substr(57), uniform) << "but for the UUID";

    runWell("render", still("--cache set.vdb --seed 9 --albedo 0.2,0.4,0.6 --aov depth normal "
                            "--half -o a.exr --write-config shot.toml"));
    const ExrFile first = readExr(path("a.exr"));
    std::filesystem::remove(path("a.exr"));
    runWell("render", "--config shot.toml");
    const ExrFile second = readExr(path("a.exr"));
    ASSERT_EQ(first.channels.size(), second.channels.size());
    for (std::size_t k = 0; k < first.channels.size(); ++k)
        EXPECT_EQ(first.channels[k].values, second.channels[k].values);
    for (const auto& [key, value] : first.metadata)
        if (key != "shadowcache:seconds" && key.starts_with("shadowcache:")) {
            EXPECT_EQ(second.metadata.at(key), value) << key;
        }

    // What was not given is not written: a default would exclude what a camera file brings.
    runWell("render", move("--frames 2 -o c.####.exr --explain --write-config move.toml"));
    runWell("render", "--config move.toml");
    EXPECT_TRUE(std::filesystem::exists(path("c.0002.exr")));

    // Command-line options take precedence.
    runWell("render", "--config shot.toml --seed 10 -o b.exr");
    EXPECT_EQ(readExr(path("b.exr")).metadata.at("shadowcache:seed"), "10");
    EXPECT_NE(readExr(path("b.exr")).channels[0].values, first.channels[0].values);
}

TEST_F(CommandLine, SettingsFileByHand) {
    folder_.write("shot.toml",
                  "# a shot\nSET = [\"set.obj\"]\nenv = \"1,1,1\"\neye = \"1,1.5,2\"\n"
                  "look-at = \"0,0.3,0\"\nsize = \"8x4\"\nsamples = 3\npng = true\n");
    runWell("render", "--config shot.toml -o a.exr");
    const ExrFile file = readExr(path("a.exr"));
    EXPECT_EQ(file.width, 8);
    EXPECT_EQ(file.metadata.at("shadowcache:samples"), "3");
    EXPECT_TRUE(std::filesystem::exists(path("a.png")));
}

TEST_F(CommandLine, RefusesBadSettingsFiles) {
    folder_.write("typo.toml", "smaples = 4\n");
    auto before = files();
    ProgramRun result = run("render", still("-o a.exr --config typo.toml"));
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find("smaples: no such option, did you mean samples?"), std::string::npos)
        << result.err;
    EXPECT_EQ(run("render", still("-o a.exr --config none.toml")).status, 2);
    folder_.write("section.toml", "[shot]\nseed = 4\n");
    result = run("render", still("-o a.exr --config section.toml"));
    EXPECT_NE(result.err.find("section [shot], expected options only"), std::string::npos)
        << result.err;
    folder_.write("empty.toml", "threads = \n");
    result = run("render", still("-o a.exr --config empty.toml"));
    EXPECT_NE(result.err.find("--threads: expected a value"), std::string::npos) << result.err;
    const auto refuses = [&](const std::string& text, const std::string& cause) {
        folder_.write("list.toml", text);
        const ProgramRun refused = run("render", still("-o a.exr --config list.toml"));
        EXPECT_EQ(refused.status, 2) << text;
        EXPECT_NE(refused.err.find(cause), std::string::npos) << refused.err;
    };
    refuses("fps = [12\n", "settings file: fps: expected ] at the list's end");
    refuses("eye = [\"1,2,\n3\"\nfps = 4", "settings file: eye: expected ] at the list's end");
    refuses("eye = []\n", "settings file: eye: expected a value");
    refuses("fps = [12\1]\n", "settings file: a byte of value 1");
    before.insert(before.end(), {"empty.toml", "list.toml", "section.toml"});
    std::ranges::sort(before);
    EXPECT_EQ(files(), before);
    expectRefusal(run("render", still("-o a.exr --write-config none/a.toml")), "render",
                  "none/a.toml");
    expectRefusal(run("render", still("-o a.exr --write-config set.obj")), "render", ".toml");
}

TEST_F(CommandLine, ManualsAreClean) {
    SHADOWCACHE_NEEDS("man and groff (Debian packages: man-db, groff-base)",
                      "command -v man && command -v groff");
    for (const std::string& program : kPrograms) {
        const std::string page = runWell(program, "--man-page").out;
        EXPECT_TRUE(page.starts_with(".TH SHADOWCACHE-")) << page.substr(0, 40);
        folder_.write("page.1", page);
        EXPECT_EQ(shell("groff -man -Tutf8 -ww page.1 > /dev/null; cat shell.err"), "");
        const std::string text = shell("MANWIDTH=100 man -l page.1 | col -b");
        for (const char* part : {"NAME", "SYNOPSIS", "OPTIONS", "--config", "Examples:"})
            EXPECT_NE(text.find(part), std::string::npos) << part << " in:\n" << text;
    }
}

TEST_F(CommandLine, BashCompletes) {
    SHADOWCACHE_NEEDS("bash", "command -v bash");
    for (const std::string& program : kPrograms)
        folder_.write(program + ".bash", runWell(program, "--bash-completion").out);
    const auto completions = [&](const std::string& program, const std::string& line) {
        return shell("source ./" + program + ".bash; COMP_WORDS=(shadowcache-" + program + " " +
                     line + "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _shadowcache_" + program +
                     "; echo ${COMPREPLY[@]}");
    };
    EXPECT_EQ(completions("render", "--est"), "--estimator\n");
    EXPECT_EQ(completions("render", "--estimator c"), "cosine cache\n");
    EXPECT_EQ(completions("render", "--up ''"), "y z\n");
    EXPECT_EQ(completions("render", "--aov op"), "openness\n");
    EXPECT_EQ(completions("render", "--env ma"), "map.exr\n");
    EXPECT_EQ(completions("render", "--samples ''"), "\n") << "nobody can foresee a number";
    EXPECT_EQ(completions("bake", "set.o"), "set.obj\n");
    EXPECT_EQ(completions("info", "--export-grid me"), "mean-direction\n");
    EXPECT_EQ(completions("merge", "--ou"), "--output\n");
}

TEST_F(CommandLine, ExplainForeseesAndWritesNothing) {
    bake();
    const auto before = files();
    const std::string text =
        runWell("render", move("--cache set.vdb --frames 1-5 -o f.####.exr --explain")).out;
    EXPECT_EQ(files(), before);
    for (const char* part :
         {"estimator   cache by default: ", "5 frames", "cache       ", "items a", "noise       ",
          "by the counts alone", "time        ", "for all"})
        EXPECT_NE(text.find(part), std::string::npos) << part << " in:\n" << text;
    const std::string plain = runWell("render", still("-o a.exr --estimator cosine --explain")).out;
    EXPECT_NE(plain.find("estimator   cosine: "), std::string::npos) << plain;
    EXPECT_EQ(plain.find("by the counts"), std::string::npos) << plain;
}

}  // namespace
}  // namespace shadowcache::test
