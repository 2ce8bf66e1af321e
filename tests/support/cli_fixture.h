#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "common/image/exr.h"
#include "common/image/image.h"
#include "tests/support/program_run.h"
#include "tests/support/temporary_folder.h"

namespace shadowcache::test {

/// A folder with a small set ("set.obj"), another one ("other.obj"), a map ("map.exr"), a camera of
/// five frames ("camera.json") and, once bake() ran, a cache ("set.vdb").
class CliTest : public testing::Test {
protected:
    CliTest() {
        const std::string table =
            "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 2 3\nf 1 3 4\n"
            "v -0.4 0.6 -0.4\nv 0.4 0.6 -0.4\nv 0.4 0.6 0.4\nv -0.4 0.6 0.4\nf 5 6 7\nf 5 7 8\n";
        folder_.write("set.obj", table);
        folder_.write("other.obj", table + "v 0 2 0\nf 5 6 9\n");
        std::vector<float> values(16 * 8, 0.5f);
        values[40] = 20;
        writeExr(path("map.exr"), 16, 8, {{"R", values}, {"G", values}, {"B", values}}, {},
                 PixelType::full);
        std::string frames;
        for (int frame = 0; frame < 5; ++frame)
            frames += fmt::format(
                R"({}{{"origin": [0.{}, 1.2, 2], "forward": [0, -0.5, -1], "up": [0, 1, 0]}})",
                frame ? "," : "", frame);
        folder_.write("camera.json",
                      R"({"cam": {"yfov": 0.9, "fps": 12, "frames": [)" + frames + "]}}");
    }

    std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

    ProgramRun run(const std::string& program, const std::string& arguments,
                   const RunLimits& limits = {}) const {
        return runProgram(program, words(arguments), folder_.path(), limits);
    }

    /// A run that must succeed and have nothing to warn of.
    ProgramRun runWell(const std::string& program, const std::string& arguments) const {
        ProgramRun result = run(program, arguments);
        EXPECT_EQ(result.status, 0) << arguments << '\n' << result.err;
        EXPECT_EQ(result.err, "") << arguments;
        return result;
    }

    void bake(const std::string& options = "") const {
        runWell("bake", "set.obj -o set.vdb --spacing 0.25 --level 3 " + options);
    }

    std::vector<std::string> files() const { return filesIn(folder_.path()); }

    /// Arguments of shadowcache-render for a still, and for the camera's frames.
    static std::string still(const std::string& options, const std::string& size = "12x8") {
        return "set.obj --env map.exr --samples 4 --eye 1,1.5,2 --look-at 0,0.3,0 --size " + size +
               " " + options;
    }
    static std::string move(const std::string& options) {
        return "set.obj --env map.exr --samples 4 --camera camera.json --size 12x8 " + options;
    }

    TemporaryFolder folder_;
};

}  // namespace shadowcache::test
