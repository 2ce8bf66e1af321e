// Bad input, options and outputs are refused with one line and leave nothing behind.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/image/exr.h"
#include "tests/support/cli_fixture.h"
#include "tests/support/mesh_files.h"

namespace shadowcache::test {
namespace {

class CliRefusal : public CliTest {
protected:
    /// Expects a refusal that leaves the folder as it was.
    void refuses(const std::string& program, const std::string& arguments, const std::string& first,
                 const std::string& second = "", const RunLimits& limits = {}) const {
        const auto before = files();
        expectRefusal(run(program, arguments, limits), program, first, second);
        EXPECT_EQ(files(), before) << arguments;
    }
};

/// A kind of file that the programs read.
struct Input {
    std::string name;
    std::string program;
    std::string arguments;  ///< '@' stands for the file
    std::string good;
    std::string newer;  ///< the same of a later format, empty where the format has no version
};

/// The bytes with `from` replaced by `to`.
std::string changed(std::string bytes, const std::string& from, const std::string& to) {
    return bytes.replace(bytes.find(from), from.size(), to);
}

std::vector<Input> inputs(const std::filesystem::path& folder) {
    const std::string bake = "@ -o new.vdb --spacing 0.5";
    const std::string view = "--eye 1,1,2 --look-at 0,0,0 --size 8x8 -o new.exr ";
    const std::string picture = "set.obj --env map.exr " + view;
    const std::string lit = "set.obj --env @ " + view;
    std::string exr = readBytes(folder / "map.exr");
    std::string newerExr = exr;
    newerExr[4] = 3;
    const std::string cache = readBytes(folder / "set.vdb");
    std::string newerCache = cache;
    const std::string key = "shadowcache_format";
    // Behind the key: the length of the type's name, the name (int32), the size of the value.
    newerCache[cache.find(key) + key.size() + 4 + 5 + 4] = 99;
    const std::string camera = readBytes(folder / "camera.json");
    const std::string hdr =
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n" + std::string(32, '\x81');
    return {
        {"in.obj", "bake", bake, squareObj(), ""},
        {"in.ply", "bake", bake, squarePly(), changed(squarePly(), "1.0", "2.0")},
        {"in.stl", "bake", bake, squareStl(), ""},
        {"in.off", "bake", bake, squareOff(), changed(squareOff(), "OFF", "4OFF")},
        {"in.om", "bake", bake, squareOm(), changed(squareOm(), "OMT\x22", "OMT\x63")},
        {"in.exr", "render", lit, exr, newerExr},
        {"in.hdr", "render", lit, hdr, changed(hdr, "rgbe", "xyze")},
        {"in.vdb", "render", picture + "--cache @", cache, newerCache},
        {"in.vdb", "render", picture + "--memory 1G --cache @", cache, newerCache},
        {"in.json", "render", "set.obj --env map.exr --camera @ --size 8x8 -o new.exr", camera,
         changed(camera, "{", "{\"version\": 2, ")},
        {"in.exr", "render", picture + "--reference @", exr, newerExr},
        {"in.vdb", "info", "@", cache, newerCache},
        {"in.vdb", "merge", "@ -o new.vdb", cache, newerCache},
    };
}

TEST_F(CliRefusal, BadInputOfEveryKind) {
    bake();
    for (const Input& input : inputs(folder_.path())) {
        const std::string arguments = changed(input.arguments, "@", input.name);
        SCOPED_TRACE(input.program + " " + arguments);
        const auto refusesBytes = [&](const std::string& bytes) {
            folder_.write(input.name, bytes);
            refuses(input.program, arguments, input.name + ": ");
        };
        refuses(input.program, arguments, input.name + ": no such file");
        refusesBytes("");
        refusesBytes(input.good.substr(0, input.good.size() / 2));
        refusesBytes("\x89PNG\r\n\x1a\n" + std::string(500, '\0'));
        if (!input.newer.empty()) refusesBytes(input.newer);
        std::filesystem::remove(path(input.name));
        std::filesystem::create_directory(path(input.name));
        refuses(input.program, arguments, input.name + ": ", "directory");
        std::filesystem::remove(path(input.name));
    }
}

// Control: the good files behind the bad ones are read.
TEST_F(CliRefusal, GoodInputOfEveryKind) {
    bake();
    writeExr(path("picture.exr"), 8, 8,
             {{"R", std::vector<float>(64)},
              {"G", std::vector<float>(64)},
              {"B", std::vector<float>(64)}},
             {}, PixelType::full);
    for (const Input& input : inputs(folder_.path())) {
        const bool reference = input.arguments.find("--reference") != std::string::npos;
        folder_.write(input.name, reference ? readBytes(path("picture.exr")) : input.good);
        runWell(input.program, changed(input.arguments, "@", input.name));
    }
}

TEST_F(CliRefusal, OutputsThatCannotBeWritten) {
    bake();
    folder_.write("file.exr", "x");
    std::filesystem::create_directory(path("folder.exr"));
    std::filesystem::create_directory(path("folder.vdb"));
    for (const std::string place : {"missing/a", "file.exr/a", "folder", "/proc/a"}) {
        refuses("bake", "set.obj --spacing 0.25 -o " + place + ".vdb", place + ".vdb: ");
        refuses("merge", "set.vdb -o " + place + ".vdb", place + ".vdb: ");
        refuses("render", still("-o " + place + ".exr"), place + ".exr: ");
    }
    for (const std::string place : {"missing/a.json", "folder.exr", "/dev/full"}) {
        refuses("render", still("-o new.exr --stats " + place), place + ": ");
        refuses("bake", "set.obj --spacing 0.25 -o new.vdb --stats " + place, place + ": ");
    }
    for (const std::string name : {"new.ply", "new", "set.obj"}) {
        refuses("bake", "set.obj -o " + name, name + ": ", ".vdb");
        refuses("render", still("-o " + name), name + ": ", ".exr");
    }
    // The programs may run as root: a rename over a device would put a file in its place.
    std::filesystem::create_symlink("/dev/full", path("full.exr"));
    std::filesystem::create_symlink("/dev/null", path("null.vdb"));
    refuses("render", still("-o full.exr"), "full.exr: is a device");
    refuses("bake", "set.obj --spacing 0.25 -o null.vdb", "null.vdb: is a device");
}

TEST_F(CliRefusal, FullDisk) {
    bake();
    for (const std::size_t limit : {0u, 1000u, 8000u}) {
        const RunLimits full{limit, {}};
        refuses("bake", "set.obj --spacing 0.1 -o new.vdb", "new.vdb: cannot be written", "", full);
        refuses("merge", "set.vdb -o new.vdb", "new.vdb: cannot be written", "", full);
        refuses("render", still("-o new.exr --aov normal position", "64x48"),
                "new.exr: cannot be written", "", full);
    }
    const auto before = readBytes(path("set.vdb"));
    refuses("bake", "set.obj --spacing 0.1 -o set.vdb", "set.vdb: ", "", {1000, {}});
    EXPECT_EQ(readBytes(path("set.vdb")), before) << "the old cache is gone";
}

TEST_F(CliRefusal, InterruptedWorkLeavesNothing) {
    const auto before = files();
    for (const int signal : {SIGINT, SIGTERM}) {
        const auto interrupt = [&](const std::string& program, const std::string& arguments) {
            const RunLimits limits{{}, afterSeconds(0.2), signal};
            expectRefusal(run(program, arguments, limits), program, "interrupted", "", kTryAgain);
        };
        interrupt("bake", "set.obj --spacing 0.001 -o new.vdb");
        interrupt("render", still("-o new.exr --samples 65536", "1024x1024"));
        EXPECT_EQ(files(), before);
    }
}

TEST_F(CliRefusal, ImpossibleOptions) {
    bake();
    const std::vector<std::array<std::string, 3>> cases{
        {"bake", "--spacing -1", "expected 0 to"},
        {"bake", "--spacing nan", "expected 0 to"},
        {"bake", "--spacing 0x", "expected 0.01x to 1000x"},
        {"bake", "--spacing nanx", "expected 0.01x to 1000x"},
        {"bake", "--spacing 2y", "as in 2x"},
        {"bake", "--spacing 1,5", "as in 2x"},
        {"bake", "--spacing 1e-9", "expected at least"},
        {"bake", "--level 6", "expected 0 to 5"},
        {"bake", "--rays 0", "expected 1 to 255"},
        {"bake", "--shard 3/2", "expected K/N with 1 <= K <= N"},
        {"bake", "--shard x", "expected K/N"},
        {"bake", "--threads -1", "expected 0 to"},
        {"bake", "--scale 0", "above 0"},
        {"bake", "--scale inf", "above 0"},
        {"render", "--target-error 0", "expected 1e-14 to"},
        {"render", "--samples -1", "expected 0 to"},
        {"render", "--samples 0", "expected at least 1"},
        {"render", "--camera-rays 0", "expected 1 to"},
        {"render", "--threads -1", "expected 0 to"},
        {"render", "--scale nan", "above 0"},
        {"render", "--env-rotate nan", "expected -1e+06 to 1e+06"},
        {"render", "--env-rotate 1-x", "expected degrees"},
        {"render", "--env-rotate 1e999", "expected -1e+06 to 1e+06"},
        {"render", "--exposure inf", "expected -64 to 64"},
        {"render", "--fov-y 180", "expected 0.01 to 179"},
        {"render", "--albedo 1.5", "expected 0 to 1"},
        {"render", "--albedo 1,1", "expected one value, or R,G,B"},
        {"render", "--material roughness=2", "expected 0 to 1"},
        {"render", "--material gloss=1", "expected roughness=, metallic=, ior= or specular="},
        {"render", "--material metallic=x", "expected a number behind each ="},
        {"render", "--material ior=0.5", "expected 1 to"},
        {"render", "--material metallic=1 --surfaces diffuse", "expected one of them"},
        {"render", "--lamp desk", "expected NAME= and a factor, or R,G,B"},
        {"render", "--lamp desk=-1", "expected NAME= and a factor, or R,G,B"},
        {"render", "--lamp desk=nan", "expected NAME= and a factor, or R,G,B"},
        {"render", "--lamp desk=1", "no lamp or emissive material of this name"},
        {"render", "--debug 12,0", "expected 0 to 11"},
        {"render", "--estimator magic", "expected one of uniform"},
        {"render", "--estimator preconvolved", "expected one of uniform"},
        {"render", "--estimator cache", "requires --cache"},
        {"render", "--memory 0 --cache set.vdb", "expected a size in bytes"},
        {"render", "--memory 4X --cache set.vdb", "expected a size in bytes"},
        {"render", "--memory -1G --cache set.vdb", "expected a size in bytes"},
    };
    for (const auto& [program, option, wanted] : cases) {
        const std::string name = words(option)[0].substr(2);
        refuses(program,
                program == "bake" ? "set.obj -o new.vdb " + option : still("-o new.exr " + option),
                name, wanted);
    }
    const std::string view = "set.obj --env map.exr -o new.exr --eye 1,1,2 --look-at 0,0,0 ";
    refuses("render", view + "--spp 0", "spp", "expected 1 to");
    refuses("render", view + "--frames 2 --shot-frames 1,3", "--shot-frames",
            "frame 2 of --frames is missing");
    const std::string json = "expected one that ends in .json";
    refuses("render", view + "--stats new.exr", "new.exr", json);
    refuses("bake", "set.obj -o new.vdb --stats set.obj", "set.obj", json);
    refuses("render", view + "--size 0x8", "--size", "expected 1 to 65536");
    refuses("render", view + "--size 65536x65536", "--size", "pixels");
    refuses("render", view + "--size 12", "--size", "expected WxH");
    refuses("render", view + "--size 8x8 --crop 4,4", "--crop", "expected X,Y,WxH");
    refuses("render", view + "--size 8x8 --crop 4,4,5x4", "--crop", "a part of the frame");
    refuses("render", view + "--size 8x8 --crop 8,0,1x1", "--crop", "a part of the frame");
    refuses("render", view + "--size 8x8 --crop 0,0,0x1", "--crop", "a part of the frame");
    refuses("render", view + "--filter-width -1", "filter-width", "expected 0 to 16");
    refuses("render", "set.obj --env 1,-1,1 -o new.exr --eye 1,1,2 --look-at 0,0,0", "--env",
            "0 or more");
    refuses("render", "set.obj --env map.exr -o new.exr --eye 1,1 --look-at 0,0,0", "--eye",
            "X,Y,Z");
    for (const std::string frames : {"0", "6", "1-9", "3-1", "1-3x0", "a"})
        refuses("render", move("-o f.####.exr --frames " + frames), "", "");
    refuses("render", move("-o f.exr --frames 1-2"), "f.exr", "frame.####.exr");
}

/// A command line that cannot be parsed has a status of its own.
TEST_F(CliRefusal, WrongUsage) {
    for (const std::string program : {"bake", "render", "info", "merge"}) {
        EXPECT_EQ(run(program, "").status, 2) << program;
        EXPECT_EQ(run(program, "--no-such-option").status, 2) << program;
    }
    const std::vector<std::array<std::string, 2>> cases{
        {"--seed -1", "--seed -1: expected a whole number from 0 to below 2^64"},
        {"--seed 18446744073709551616",
         "--seed 18446744073709551616: expected a whole number from 0 to below 2^64"},
        {"--samples many", "--samples many: expected a whole number"},
        {"--exposure bright", "--exposure bright: expected a number"},
        {"--up x", "--up x: expected one of y, z"},
        {"--sequence soboll",
         "--sequence soboll: expected one of sobol, random, did you mean sobol?"},
        {"--camera move.json", "--camera cannot be combined with --eye"},
        {"--seed", "--seed: expected a value"},
        {"--config none.toml", "none.toml: cannot be read"},
    };
    for (const auto& [option, message] : cases) {
        const ProgramRun result = run("render", still("-o new.exr " + option));
        EXPECT_EQ(result.status, 2) << option;
        EXPECT_EQ(result.err,
                  "shadowcache-render: " + message + "\nRun with --help for more information.\n");
    }
    EXPECT_EQ(run("render", still("--aov colour -o new.exr")).status, 2);
}

TEST_F(CliRefusal, EstimatesThatAreNotFiniteFailTheRun) {
    const std::string blinding =
        "set.obj --env 3e38,3e38,3e38 --eye 0.1,2,1 --look-at 0,0,0 --size 8x8 --fov-y 20 --seed 5 "
        "-o new.exr";
    refuses("render", blinding, "64 pixels without a finite estimate", "--debug 0,0 --seed 5");
    refuses("render", blinding + " --debug 0,0", "the estimate is not finite");
}

}  // namespace
}  // namespace shadowcache::test
