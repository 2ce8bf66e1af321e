// A set that shines, as typed: what its bake tells of emitters, which caches lack them, and how
// they are added.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

/// A floor under a lamp.
class BakedLamps : public CliTest {
protected:
    BakedLamps() {
        folder_.write("lit.mtl", "newmtl lamp\nKd 0 0 0\nKe 4 3 2\n");
        folder_.write("lit.obj", litFloor("1"));
    }

    static std::string litFloor(const std::string& height) {
        std::string text =
            "mtllib lit.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 1 4 3 2\nusemtl lamp\n";
        for (const auto& [x, z] : {std::pair("-.2 ", " -.2\n"), std::pair(".2 ", " -.2\n"),
                                   std::pair(".2 ", " .2\n"), std::pair("-.2 ", " .2\n")})
            text += "v " + (x + height) + z;
        return text + "f 5 6 7 8\n";
    }

    /// @return its statistics
    Json bakeLit(const std::string& options) const {
        runWell("bake", "lit.obj --spacing 0.25 --level 2 --rays 1 --stats s.json " + options);
        return Json::parse(readBytes(path("s.json")));
    }
};

TEST_F(BakedLamps, AreTold) {
    const Json predicted = bakeLit("--estimate")["estimate"];
    const Json baked = bakeLit("-o lit.vdb");
    const Json info = Json::parse(runWell("info", "lit.vdb --json").out);
    EXPECT_EQ(info["emitters"], 1);
    EXPECT_EQ(baked["cache"]["emitters"], 1);
    EXPECT_EQ(predicted["emitters"], 1);
    // All voxels are the sample. Only rays from below the lamp's plane are traced and kept.
    EXPECT_GT(baked["rays"]["emitters"], 0);
    EXPECT_LT(baked["rays"]["emitters"], baked["rays"]["bake"]);
    EXPECT_EQ(predicted["emitter_rays"], baked["rays"]["emitters"]);
    EXPECT_EQ(info["emitter_rays"], baked["rays"]["emitters"]);
    EXPECT_EQ(info["bytes"]["items"]["emitters"], info["items"].get<int>() * 2);
    EXPECT_GT(info["bytes"]["emitters"], 0);
    EXPECT_LT(info["bytes"]["emitters"], info["bytes"]["file"]);
    EXPECT_EQ(baked["cache"]["emitter_bytes"], info["bytes"]["emitters"]);
    EXPECT_NE(runWell("info", "lit.vdb").out.find("emitters       1 counted by "),
              std::string::npos);

    const Json without = bakeLit("--no-lamps -o dark.vdb");
    EXPECT_EQ(without["rays"]["emitters"], 0);
    EXPECT_EQ(without["cache"]["emitters"], 0);
    EXPECT_EQ(without["cache"]["emitter_bytes"], 0);
    EXPECT_EQ(without["rays"]["bake"],
              baked["rays"]["bake"].get<int>() - baked["rays"]["emitters"].get<int>());
    const Json less = bakeLit("--no-lamps --estimate")["estimate"];
    EXPECT_EQ(less["emitters"], 0);
    EXPECT_EQ(less["emitter_rays"], 0);
    EXPECT_EQ(less["rays"], without["rays"]["bake"]);
    EXPECT_NE(runWell("info", "dark.vdb").out.find("emitters       none counted"),
              std::string::npos);
}

TEST_F(BakedLamps, AreAddedToACacheWithoutThem) {
    bakeLit("-o lit.vdb");
    bakeLit("--no-lamps -o dark.vdb");
    const ProgramRun extended =
        runWell("bake", "lit.obj --rays 1 --stats s.json --extend dark.vdb -o both.vdb");
    EXPECT_NE(extended.out.find("dark.vdb: emitters (1) counted for its "), std::string::npos)
        << extended.out;
    const Json more = Json::parse(readBytes(path("s.json")));
    EXPECT_EQ(readBytes(path("both.vdb")), readBytes(path("lit.vdb")));
    EXPECT_GT(more["rays"]["emitters"], 0);
    EXPECT_EQ(more["rays"]["emitters"], more["rays"]["bake"]);
    expectRefusal(run("bake", "lit.obj --level 2 --rays 1 --no-lamps --extend lit.vdb -o a.vdb"),
                  "bake", "lit.vdb: counts 1 emitter, expected none as in this bake", "--no-lamps");
    expectRefusal(run("merge", "lit.vdb dark.vdb -o a.vdb"), "merge", "dark.vdb",
                  "counts no emitters, expected the 1 of lit.vdb");
}

}  // namespace
}  // namespace shadowcache::test
