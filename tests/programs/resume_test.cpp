// What --resume of the renderer takes for the same input: the same content, wherever and whenever.

#include <fmt/core.h>

#include <cstring>
#include <fstream>
#include <utility>

#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

namespace fs = std::filesystem;

/// A glTF set whose positions are in a file of their own, and a frame of it that is done.
class ResumeTest : public CliTest {
protected:
    ResumeTest() {
        folder_.write("set.gltf", R"({"asset": {"version": "2.0"}, "scene": 0,
            "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                           "min": [-1, 0, -1], "max": [1, 0, 1]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"uri": "the%20points.bin", "byteLength": 36}]})");
        writePoints(1);
        render("", 1, 0);
    }

    void writePoints(float size) const {
        const float points[] = {-size, 0, -1, 0, 0, 1, 1, 0, -1};
        std::string bytes(sizeof points, ' ');
        std::memcpy(bytes.data(), points, sizeof points);
        folder_.write("the points.bin", bytes);
    }

    void render(const std::string& from, int wanted, int kept) const {
        const auto result =
            runWell("render", from + "set.gltf --env " + from +
                                  "map.exr --samples 4 --eye 1,1.5,2 --look-at 0,0.3,0 --size 12x8 "
                                  "--resume -o a.exr");
        const std::string text =
            fmt::format("{} {} ({} more", wanted, wanted == 1 ? "frame" : "frames", kept);
        EXPECT_NE(result.out.find(text), std::string::npos) << text << " in: " << result.out;
    }
};

TEST_F(ResumeTest, ADateIsNoContent) {
    for (const char* name : {"set.gltf", "the points.bin", "map.exr"})
        fs::last_write_time(path(name), fs::last_write_time(path(name)) + std::chrono::hours(7));
    render("", 0, 1);
}

TEST_F(ResumeTest, ACopyIsTheSameInput) {
    fs::create_directory(path("stage"));
    for (const char* name : {"set.gltf", "the points.bin", "map.exr"})
        fs::copy_file(path(name), path("stage") / name);
    render("stage/", 0, 1);
}

/// Same size, same date, another content: in a file that the set only refers to.
TEST_F(ResumeTest, AFileThatTheSetRefersToIsInput) {
    const auto date = fs::last_write_time(path("the points.bin"));
    writePoints(0.5f);
    fs::last_write_time(path("the points.bin"), date);
    render("", 1, 0);
    render("", 0, 1);
}

TEST_F(ResumeTest, AMapOfTheSameSizeAndDateIsAnother) {
    const auto date = fs::last_write_time(path("map.exr"));
    std::string bytes = readBytes(path("map.exr"));
    bytes[bytes.size() - 3] = static_cast<char>(bytes[bytes.size() - 3] ^ 1);
    folder_.write("map.exr", bytes);
    fs::last_write_time(path("map.exr"), date);
    const auto result = run("render",
                            "set.gltf --env map.exr --samples 4 --eye 1,1.5,2 --look-at 0,0.3,0 "
                            "--size 12x8 --resume -o a.exr");
    // The changed map may be unreadable, but the frame is not taken for done.
    EXPECT_EQ(result.out.find("1 more was done"), std::string::npos) << result.out;
}

/// Whether a run takes a.exr for done.
/// A folder that may only be read, as another user's.
class ReadOnly : public CliTest {
protected:
    ReadOnly() { runWell("render", kShot); }
    ~ReadOnly() override { fs::permissions(path("."), fs::perms::owner_all); }

    void protect() const {
        for (const std::string& name : files()) fs::permissions(path(name), fs::perms(0444));
        fs::permissions(path("."), fs::perms(0555));
    }
    ProgramRun asNobody(const std::string& arguments) const {
        return run("render", arguments, {.nobody = true});
    }

    const std::string kShot = move("--frames 1-2 -o f.####.exr");
};

TEST_F(ReadOnly, FoldersAreCheckedResumedAndExplained) {
    protect();
    for (const char* words : {" --check", " --resume", " --explain", " --resume --explain"}) {
        const ProgramRun done = asNobody(kShot + words);
        EXPECT_EQ(done.status, kDone) << words << done.err;
        EXPECT_EQ(done.err, "") << words;
    }
    // What must be written is refused before the set is read, as ever.
    expectRefusal(asNobody(kShot), "render", "f.0001.exr", "Permission denied");
    expectRefusal(asNobody(move("--frames 1-3 -o f.####.exr --resume")), "render",
                  "Permission denied");
}

TEST_F(ReadOnly, AFileBeyondTheUsersLimitIsRefusedInALine) {
    expectRefusal(run("render", still("-o a.exr", "64x64"), {.fileBytes = 1000}), "render", "a.exr",
                  "File too large");
}

TEST_F(ReadOnly, MissingFoldersHaveMissingFrames) {
    const ProgramRun done = run("render", move("--frames 1-2 -o none/f.####.exr --check"));
    EXPECT_EQ(done.status, kFailed);
    EXPECT_EQ(done.err,
              "none/f.0001.exr: missing\nnone/f.0002.exr: missing\n"
              "shadowcache-render: --check: 0 of 2 frames are done, expected all\n");
}

class ResumeSettings : public CliTest {
protected:
    ResumeSettings() { runWell("render", kWords + "--env 1,1,1 --png -o a.exr"); }

    bool isDone(const std::string& words) const {
        const auto result = runWell("render", kWords + words + " --resume -o a.exr");
        return result.out.find("0 frames (1 more was done)") != std::string::npos;
    }

    const std::string kWords = "set.obj --samples 1 --eye 1,1.5,2 --look-at 0,0.3,0 --size 12x8 ";
};

TEST_F(ResumeSettings, ARadianceIsOne) {
    EXPECT_TRUE(isDone("--env 1,1,1"));
    EXPECT_FALSE(isDone("--env 5,0,0"));
}

TEST_F(ResumeSettings, APngShowsItsPicture) {
    EXPECT_TRUE(isDone("--env 1,1,1 --png"));
    EXPECT_FALSE(isDone("--env 1,1,1 --png --exposure 3"));
    EXPECT_TRUE(isDone("--env 1,1,1 --png --exposure 3"));
    // The EXR does not depend on it.
    EXPECT_TRUE(isDone("--env 1,1,1"));
    runWell("render", kWords + "--env 5,0,0 --exposure 3 -o a.exr");
    EXPECT_TRUE(isDone("--env 5,0,0 --exposure 3"));
    EXPECT_FALSE(isDone("--env 5,0,0 --exposure 3 --png"));
}

}  // namespace
}  // namespace shadowcache::test
