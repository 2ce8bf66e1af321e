// Light that bounces, as typed: the default, its preview, marks and refusals.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "common/image/exr.h"
#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

class BouncesCli : public CliTest {
protected:
    /// Sum of a picture's values.
    double light(const std::string& file) const {
        double sum = 0;
        for (const Channel& channel : readExr(path(file)).channels)
            for (const float value : channel.values) sum += static_cast<double>(value);
        return sum;
    }

    std::string attribute(const std::string& file, const std::string& name) const {
        return readExr(path(file)).metadata.at("shadowcache:" + name);
    }
};

TEST_F(BouncesCli, AreFourUnlessOthersAreAskedFor) {
    bake();
    RunLimits typed;
    typed.standardBounces = true;
    const std::string view = still("--cache set.vdb -o ");
    EXPECT_EQ(run("render", view + "standard.exr", typed).status, 0);
    runWell("render", view + "four.exr --bounces 4");
    runWell("render", view + "none.exr --bounces 0");
    EXPECT_EQ(light("standard.exr"), light("four.exr"));
    EXPECT_GT(light("four.exr"), 1.005 * light("none.exr"));
    EXPECT_EQ(attribute("standard.exr", "bounces"), "4");
    EXPECT_EQ(attribute("standard.exr", "bias"), "none");
    runWell("render", view + "all.exr --bounces unlimited");
    EXPECT_EQ(attribute("all.exr", "bounces"), "unlimited");
}

TEST_F(BouncesCli, ArePredictedByTheTransportInTheCache) {
    bake();
    const auto predicted = runWell(
        "render", still("--cache set.vdb --preview --samples 0 --bounces 4 -o preview.exr"));
    EXPECT_NE(predicted.out.find(" 1 x 0 samples"), std::string::npos) << predicted.out;
    EXPECT_EQ(predicted.out.find("it knows of bounces in"), std::string::npos)
        << "without --memory";
    const auto direct = runWell("render", still("--cache set.vdb --preview --samples 0 --bounces 0 "
                                                "--memory 1G -o direct.exr"));
    EXPECT_EQ(direct.out.find("it knows of bounces in"), std::string::npos) << direct.out;
    const auto inPages =
        runWell("render", still("--cache set.vdb --preview --samples 0 --memory 1G "
                                "--bounces 4 -o pages.exr"));
    EXPECT_NE(inPages.out.find("; what it knows of bounces in 0."), std::string::npos)
        << inPages.out;
    EXPECT_EQ(light("pages.exr"), light("preview.exr"));
    EXPECT_GT(light("preview.exr"), 1.005 * light("direct.exr"));
    runWell("bake", "set.obj -o bare.vdb --spacing 0.25 --level 3 --no-transport");
    const auto unpredicted =
        runWell("render", still("--cache bare.vdb --bounces 4 -o unpredicted.exr"));
    EXPECT_NE(unpredicted.out.find("holds no transport"), std::string::npos) << unpredicted.out;
    expectRefusal(
        run("render", still("--cache bare.vdb --preview --samples 0 --bounces 4 -o new.exr")),
        "render", "bare.vdb", "--no-transport");
}

TEST_F(BouncesCli, AreRefusedWhereTheyCannotBe) {
    bake();
    expectRefusal(run("render", still("--bounces -1 -o new.exr")), "render", "--bounces -1",
                  "0 to 1000");
    expectRefusal(run("render", still("--bounces all -o new.exr")), "render", "--bounces all",
                  "unlimited");
}

TEST_F(BouncesCli, AreMarkedAsBiasedWhereTheyAreClamped) {
    runWell("render", still("--bounces 2 --clamp-indirect 0.01 -o clamped.exr"));
    runWell("render", still("--bounces 2 -o whole.exr"));
    EXPECT_LT(light("clamped.exr"), light("whole.exr"));
    EXPECT_NE(attribute("clamped.exr", "bias").find("clamp-indirect"), std::string::npos);
    EXPECT_EQ(attribute("whole.exr", "bias"), "none");
}

TEST_F(BouncesCli, AddUpFromTheirAovs) {
    bake();
    runWell("render", still("--cache set.vdb --bounces 2 -o parts.exr --aov "
                            "diffuse_direct,diffuse_indirect,glossy_direct,glossy_indirect,"
                            "emission"));
    const ExrFile file = readExr(path("parts.exr"));
    const auto values = [&](const std::string& name) {
        for (const Channel& channel : file.channels)
            if (channel.name == name) return channel.values;
        ADD_FAILURE() << name;
        return std::vector<float>();
    };
    const std::vector<float> green = values("G");
    std::vector<float> sum(green.size(), 0.0f);
    for (const char* part :
         {"diffuse_direct", "diffuse_indirect", "glossy_direct", "glossy_indirect", "emission"}) {
        const std::vector<float> more = values(std::string(part) + ".G");
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += more[i];
    }
    for (std::size_t i = 0; i < sum.size(); ++i)
        EXPECT_NEAR(sum[i], green[i], 1e-5f * std::abs(green[i]) + 1e-6f);
}

}  // namespace
}  // namespace shadowcache::test
