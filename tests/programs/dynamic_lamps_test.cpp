// Lamps of files of --dynamic: they follow their tracks, and have gains, groups and names as
// others.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/image/exr.h"
#include "tests/support/cli_fixture.h"
#include "tests/support/gltf_builder.h"

namespace shadowcache::test {
namespace {

/// A lamp without a surface.
GltfBuilder deskLamp(GltfBuilder file, const nlohmann::json& place) {
    file.json["extensionsUsed"] = {"KHR_lights_punctual"};
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"name", "desk"}, {"intensity", 4}, {"extras", {{"radius", 0.05}}}}};
    file.root({{"translation", place}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    return file;
}

/// A square, and a lamp that its track puts over it in frame 1, elsewhere in frame 2, and hides in
/// frame 3.
class DynamicLamps : public CliTest {
protected:
    DynamicLamps() {
        folder_.write("square.glb", squareScene().glb());
        folder_.write("desk.glb", deskLamp({}, {0.25, 0, 0.5}).glb());
        folder_.write("there.glb", deskLamp(squareScene(), {0.5, 0.5, 1}).glb());
        folder_.write("t.json", R"({"frames": [{"translation": [0.25, 0.5, 0.5]},
            {"translation": [-0.25, 0.5, 0.5]}, {"scale": [0, 0, 0]}]})");
    }

    static std::string look(const std::string& options) {
        return "--env 0,0,0 --eye 0.5,0.5,2 --look-at 0.5,0.51,0 --size 8x8 --spp 8 --bounces 1 " +
               options;
    }
    static std::string lit(const std::string& options) {
        return "square.glb --dynamic desk.glb@t.json " + look(options);
    }

    std::vector<float> channel(const std::string& file, const std::string& name = "G") const {
        const ExrFile read = readExr(path(file));
        const auto found = std::ranges::find(read.channels, name, &Channel::name);
        EXPECT_NE(found, read.channels.end()) << file << " " << name;
        return found == read.channels.end() ? std::vector<float>() : found->values;
    }
    std::vector<float> picture(const std::string& arguments) const {
        runWell("render", arguments + " -o a.exr");
        return channel("a.exr");
    }
    static float most(const std::vector<float>& values) { return std::ranges::max(values); }
};

TEST_F(DynamicLamps, AreWhereTheirTrackIs) {
    const ProgramRun first = runWell("render", lit("--frames 1 -o first.exr"));
    EXPECT_NE(first.out.find("moving lamps: 1, not in the cache"), std::string::npos) << first.out;
    const std::vector<float> here = channel("first.exr");
    EXPECT_GT(most(here), 0.1f);
    EXPECT_EQ(here, picture("there.glb " + look("--frames 1")));
    EXPECT_NE(here, picture(lit("--frames 2")));  // the control
    EXPECT_EQ(most(picture(lit("--frames 3"))), 0);
    EXPECT_EQ(here, picture("square.glb --dynamic there.glb --set-frame 9 " + look("--frames 1")));
    expectRefusal(run("render", lit("--frames 4 -o b.exr")), "render", "t.json",
                  "frame 4, expected 1 to 3");
}

TEST_F(DynamicLamps, HaveGainsGroupsAndNames) {
    const std::vector<float> usual = picture(lit(""));
    std::vector<float> twice = usual;
    for (float& value : twice) value *= 2;
    EXPECT_EQ(picture(lit("--lamp d*=2")), twice);
    EXPECT_EQ(most(picture(lit("--lamps off"))), 0);
    expectRefusal(run("render", lit("--lamp dusk=2 -o b.exr")), "render", "--lamp dusk", "desk?");
    runWell("render", lit("--light-groups * -o a.exr"));
    const std::vector<float> ofGroup = channel("a.exr", "desk.G");
    ASSERT_EQ(ofGroup.size(), usual.size());
    for (std::size_t i = 0; i < usual.size(); ++i) EXPECT_NEAR(ofGroup[i], usual[i], 1e-5f) << i;
    const ProgramRun list = runWell("render", "square.glb --dynamic desk.glb@t.json --list");
    EXPECT_NE(list.out.find("desk.glb:\n  lamp desk: point, intensity 4,4,4, moves"),
              std::string::npos)
        << list.out;
}

TEST_F(DynamicLamps, LeaveTheCacheAsItIs) {
    runWell("bake", "square.glb -o plain.vdb --spacing 0.25 --level 2 --rays 1");
    const std::vector<float> with = picture(lit("--cache plain.vdb"));
    EXPECT_GT(most(with), 0.1f);
    EXPECT_NE(with, picture(lit("--cache plain.vdb --frames 2")));
    expectRefusal(run("render", lit("--cache plain.vdb --preview -o b.exr")), "render",
                  "lamps that move", "without --preview");
    // Those of the shot, too.
    runWell(
        "bake",
        "there.glb -o shot.vdb --spacing 0.25 --level 2 --rays 1 --camera camera.json --size 8x8 "
        "--frames 1-2 --dynamic desk.glb@t.json");
}

}  // namespace
}  // namespace shadowcache::test
