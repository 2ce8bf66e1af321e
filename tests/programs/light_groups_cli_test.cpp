// Light groups as typed: their channels add up, a mix has the gains that are asked for and can be
// mixed again, and what is missing is named.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "common/image/exr.h"
#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

class LightGroupsCli : public CliTest {
protected:
    LightGroupsCli() {
        folder_.write("night.mtl",
                      "newmtl wood\nKd 0.6 0.5 0.4\nnewmtl left\nKd 0 0 0\nKe 4 3 2\n"
                      "newmtl right\nKd 0 0 0\nKe 1 2 3\n");
        folder_.write("night.obj",
                      "mtllib night.mtl\nusemtl wood\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\n"
                      "f 1 4 3 2\nusemtl left\nv -1 0.8 -1\nv -0.6 0.8 -1\nv -0.6 0.8 0\n"
                      "v -1 0.8 0\nf 5 6 7 8\nusemtl right\nv 0.6 0.8 -1\nv 1 0.8 -1\n"
                      "v 1 0.8 0\nv 0.6 0.8 0\nf 9 10 11 12\n");
    }

    static std::string night(const std::string& options) {
        return "night.obj --env map.exr --samples 4 --bounces 1 --eye 0,1,2 --look-at 0,0.2,0 "
               "--size 12x8 " +
               options;
    }

    std::vector<float> channel(const std::string& file, const std::string& name) const {
        const ExrFile read = readExr(path(file));
        const auto found = std::ranges::find(read.channels, name, &Channel::name);
        EXPECT_NE(found, read.channels.end()) << file << " " << name;
        return found == read.channels.end() ? std::vector<float>() : found->values;
    }

    /// Expects that the channels of a file are such multiples of those of another.
    struct Term {
        std::string channel;
        float factor;
    };
    void expectSum(const std::string& file, const std::string& name, const std::string& from,
                   const std::vector<Term>& terms) const {
        const std::vector<float> found = channel(file, name);
        std::vector<std::vector<float>> parts;
        for (const Term& term : terms) parts.push_back(channel(from, term.channel));
        for (std::size_t i = 0; i < found.size(); ++i) {
            float sum = 0;
            for (std::size_t k = 0; k < terms.size(); ++k) sum += terms[k].factor * parts[k][i];
            ASSERT_NEAR(found[i], sum, 1e-5f * (1 + std::abs(sum))) << name << " " << i;
        }
    }
};

TEST_F(LightGroupsCli, AddUpToThePicture) {
    runWell("render", night("--light-groups * -o a.exr"));
    runWell("render", night("-o plain.exr"));
    EXPECT_EQ(channel("a.exr", "R"), channel("plain.exr", "R"));
    for (const std::string c : {"R", "G", "B"}) {
        expectSum("a.exr", c, "a.exr",
                  {{"sky." + c, 1}, {"left." + c, 1}, {"right." + c, 1}, {"rest." + c, 1}});
        const std::vector<float> left = channel("a.exr", "left." + c);
        EXPECT_GT(*std::ranges::max_element(left), 0.01f);
    }
    EXPECT_FALSE(readExr(path("plain.exr")).metadata.contains("shadowcache:groups"));
}

TEST_F(LightGroupsCli, AreMixed) {
    runWell("render", night("--light-groups * --aov normal --transparent -o a.exr"));
    const auto mixed =
        runWell("render", "--mix a.exr --gain *=0.5 --gain left=2,0,1 -o b.exr --png");
    EXPECT_NE(mixed.out.find("4 light groups -> b.exr"), std::string::npos) << mixed.out;
    EXPECT_TRUE(std::filesystem::exists(path("b.png")));
    expectSum("b.exr", "R", "a.exr",
              {{"left.R", 2}, {"right.R", 0.5f}, {"sky.R", 0.5f}, {"rest.R", 0.5f}});
    expectSum("b.exr", "G", "a.exr", {{"right.G", 0.5f}, {"sky.G", 0.5f}, {"rest.G", 0.5f}});
    expectSum("b.exr", "left.R", "a.exr", {{"left.R", 2}});
    EXPECT_EQ(channel("b.exr", "A"), channel("a.exr", "A"));
    const ExrFile a = readExr(path("a.exr")), b = readExr(path("b.exr"));
    EXPECT_TRUE(std::ranges::none_of(
        b.channels, [](const Channel& c) { return c.name.starts_with("normal"); }));
    EXPECT_EQ(a.view.worldToCamera, b.view.worldToCamera);
    EXPECT_EQ(b.metadata.at("shadowcache:mix"), "*=0.5,0.5,0.5 left=2,0,1");
    // A mix is mixed again.
    runWell("render", "--mix b.exr --gain right=2 -o c.exr");
    expectSum("c.exr", "B", "a.exr",
              {{"left.B", 1}, {"right.B", 1}, {"sky.B", 0.5f}, {"rest.B", 0.5f}});
    // It is not the frame that --resume would render.
    runWell("render", night("--light-groups * --aov normal --transparent --resume -o a.exr"));
    const auto again =
        runWell("render", night("--light-groups * --aov normal --transparent --resume -o c.exr"));
    EXPECT_NE(again.out.find("rendered again"), std::string::npos) << again.out;
}

TEST_F(LightGroupsCli, AreRefusedByName) {
    runWell("render", night("--light-groups * -o a.exr"));
    runWell("render", night("-o plain.exr"));
    const auto before = files();
    const auto refused = [&](const std::string& arguments, const std::string& first,
                             const std::string& second) {
        expectRefusal(run("render", arguments), "render", first, second);
    };
    refused("--mix plain.exr --gain sky=0 -o b.exr", "plain.exr", "--light-groups");
    refused("--mix a.exr --gain lift=2 -o b.exr", "--gain lift", "left?");
    refused("--mix a.exr --gain left -o b.exr", "--gain left", "NAME=");
    refused("--mix a.exr --gain left=-1 -o b.exr", "--gain left=-1", "0 to 1e6");
    refused("--mix none.exr --gain left=1 -o b.exr", "none.exr", "");
    refused("--mix a.exr --gain left=2 -o a.exr", "a.exr", "another file");
    refused(night("--light-groups lamp -o b.exr"), "--light-groups lamp", "no lamp");
    refused(night("--light-groups sky=left -o b.exr"), "--light-groups sky", "with another one");
    refused(night("--lamps off --light-groups * -o b.exr"), "--light-groups *", "no lamp");
    EXPECT_EQ(files(), before);
    for (const char* arguments :
         {"--mix a.exr --gain left=2", "--gain left=2 -o b.exr",
          "night.obj --mix a.exr --gain left=2 -o b.exr", "--mix a.exr --size 4x4 -o b.exr"})
        EXPECT_EQ(run("render", arguments).status, 2) << arguments;
}

TEST_F(LightGroupsCli, ArePreviewedWithoutRaysOnly) {
    runWell("bake", "night.obj -o night.vdb --spacing 0.25 --level 3");
    runWell("render", night("--cache night.vdb --preview --samples 0 --light-groups * -o a.exr"));
    expectSum("a.exr", "G", "a.exr", {{"sky.G", 1}, {"left.G", 1}, {"right.G", 1}, {"rest.G", 1}});
    expectRefusal(run("render", night("--cache night.vdb --preview --light-groups * -o b.exr")),
                  "render", "--light-groups with --preview", "--spp 0");
}

// In a server, a gain is a change of light: the picture is the one of --lamp, bit for bit.
TEST_F(LightGroupsCli, HaveGainsInAServerWithoutALoad) {
    runWell("bake", "night.obj -o night.vdb --spacing 0.25 --level 3");
    folder_.write("moving.obj",
                  "mtllib night.mtl\nusemtl left\nv -0.2 0.1 0\nv 0.2 0.1 0\nv 0 0.5 0\nf 1 2 3\n");
    const std::string requests =
        R"({"id":1,"request":"load","set":["night.obj"],"cache":"night.vdb","dynamic":["moving.obj"]}
{"id":2,"request":"environment","map":"map.exr"}
{"id":3,"request":"camera","eye":[0,1,2],"look-at":[0,0.2,0]}
{"id":4,"request":"size","width":12,"height":8}
{"id":5,"request":"options","samples":4,"bounces":1}
{"id":6,"request":"render","pixels":"a.pix"}
{"id":7,"request":"lamps","lamp":["left=3,1,1"]}
{"id":8,"request":"render","pixels":"b.pix"}
{"id":9,"request":"lamps","lamp":["lift=3"]}
{"id":10,"request":"lamps","lamp":[]}
{"id":11,"request":"render","pixels":"c.pix"}
{"id":12,"request":"quit"}
)";
    RunLimits limits;
    limits.standardBounces = true;
    limits.input = folder_.write("requests", requests);
    const ProgramRun served = run("render", "--serve", limits);
    EXPECT_EQ(served.status, 0) << served.err;
    EXPECT_NE(served.out.find("lamp lift: no lamp"), std::string::npos) << served.out;
    const std::string set = "--cache night.vdb --dynamic moving.obj ";
    runWell("render", night(set + "-o a.exr"));
    runWell("render", night(set + "--lamp left=3,1,1 -o b.exr"));
    const auto red = [&](const std::string& file) {
        const std::string bytes = readBytes(path(file));
        std::vector<float> values(12 * 8);
        EXPECT_GE(bytes.size(), 64 + values.size() * sizeof(float));
        std::memcpy(values.data(), bytes.data() + 64, values.size() * sizeof(float));
        return values;
    };
    EXPECT_EQ(red("a.pix"), channel("a.exr", "R"));
    EXPECT_EQ(red("b.pix"), channel("b.exr", "R"));
    EXPECT_EQ(red("c.pix"), channel("a.exr", "R"));
    EXPECT_NE(red("b.pix"), red("a.pix"));
}

}  // namespace
}  // namespace shadowcache::test
