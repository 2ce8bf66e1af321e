// The AOVs that show what the cache says of each pixel.

#include <gtest/gtest.h>

#include <cmath>

#include "common/image/exr.h"
#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

class CacheAov : public CliTest {
protected:
    /// Values of a channel of a rendered picture.
    std::vector<float> channel(const std::string& picture, const std::string& name) const {
        for (Channel& channel : readExr(path(picture)).channels)
            if (channel.name == name) return channel.values;
        ADD_FAILURE() << "no channel " << name;
        return {};
    }
};

double mean(const std::vector<float>& values) {
    double sum = 0;
    for (const float value : values) sum += static_cast<double>(value);
    return sum / static_cast<double>(values.size());
}

TEST_F(CacheAov, TellsWhatTheCacheHolds) {
    bake("--write-config bake.toml");
    const std::string aovs = "--aov depth openness expected_noise items misses variance ";
    runWell("render", still("--cache set.vdb -o a.exr --png " + aovs, "48x32"));
    const auto depth = channel("a.exr", "depth.Z"), openness = channel("a.exr", "openness.Y"),
               noise = channel("a.exr", "expected_noise.Y"), items = channel("a.exr", "items.Y"),
               misses = channel("a.exr", "misses.Y"), variance = channel("a.exr", "variance.Y");
    double lowest = 1, highest = 0, expected = 0;
    for (std::size_t i = 0; i < depth.size(); ++i) {
        if (depth[i] == 0) {
            EXPECT_EQ(items[i] + misses[i] + openness[i] + noise[i], 0) << "the sky";
            continue;
        }
        EXPECT_EQ(misses[i], 0);
        EXPECT_GE(items[i], 1);
        EXPECT_LE(items[i], 16);
        lowest = std::min(lowest, static_cast<double>(openness[i]));
        highest = std::max(highest, static_cast<double>(openness[i]));
        expected += static_cast<double>(noise[i] * noise[i]) / static_cast<double>(depth.size());
    }
    EXPECT_GT(highest, 0.99) << "the table's top";
    EXPECT_LT(lowest, 0.75) << "under the table";
    // The counts foresee the noise that the samples show.
    EXPECT_GT(expected, 0.2 * mean(variance));
    EXPECT_LT(expected, 5 * mean(variance));
    for (const char* name :
         {"a.png", "a.openness.png", "a.expected_noise.png", "a.items.png", "a.misses.png"})
        EXPECT_TRUE(std::filesystem::exists(path(name))) << name;
    EXPECT_FALSE(std::filesystem::exists(path("a.depth.png")));
}

TEST_F(CacheAov, ChangeNoPixel) {
    bake();
    runWell("render", still("--cache set.vdb --budget adaptive -o a.exr"));
    runWell("render", still("--cache set.vdb --budget adaptive -o b.exr --aov items openness"));
    for (const char* name : {"R", "G", "B"})
        EXPECT_EQ(channel("a.exr", name), channel("b.exr", name));
}

TEST_F(CacheAov, MoreSamplesExpectLessNoise) {
    bake();
    const std::string options = "--cache set.vdb --budget uniform --aov expected_noise ";
    runWell("render", still(options + "-o a.exr"));
    runWell("render", still(options + "-o b.exr --samples 16"));
    const double few = mean(channel("a.exr", "expected_noise.Y"));
    EXPECT_GT(few, 0);
    // Each run has a pilot of its own, whose corrections depend on no number of samples.
    EXPECT_NEAR(few / mean(channel("b.exr", "expected_noise.Y")), 2, 0.01);
    run("render", still(options + "-o c.exr --preview --samples 0"));
    EXPECT_EQ(mean(channel("c.exr", "expected_noise.Y")), 0) << "a preview has none";
}

TEST_F(CacheAov, MissesWhereTheCacheKnowsNothing) {
    bake();
    // The other set has a triangle more, high above all voxels of this one's cache.
    run("render",
        "other.obj --env map.exr --samples 4 --eye 1,2.5,3 --look-at 0,1.2,0 "
        "--size 32x32 --cache set.vdb --stale-ok -o a.exr --aov misses items depth");
    const auto depth = channel("a.exr", "depth.Z"), misses = channel("a.exr", "misses.Y"),
               items = channel("a.exr", "items.Y");
    int missed = 0, found = 0;
    for (std::size_t i = 0; i < depth.size(); ++i) {
        if (depth[i] == 0) continue;
        EXPECT_EQ(misses[i], items[i] == 0 ? 1 : 0);
        (misses[i] > 0 ? missed : found) += 1;
    }
    EXPECT_GT(missed, 20);
    EXPECT_GT(found, 20);
}

TEST_F(CacheAov, WantsTheEstimatorThatKnows) {
    bake();
    const auto before = files();
    expectRefusal(run("render", still("--aov items -o a.exr")), "render", "--aov items",
                  "--estimator cache");
    expectRefusal(run("render", still("--cache set.vdb --estimator mis --aov misses -o a.exr")),
                  "render", "--aov misses");
    EXPECT_EQ(files(), before);
}

}  // namespace
}  // namespace shadowcache::test
