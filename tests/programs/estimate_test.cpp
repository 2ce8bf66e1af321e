// `shadowcache-bake --estimate` against the bake that it predicts.

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/cli_fixture.h"

namespace shadowcache::test {
namespace {

using Json = nlohmann::json;

/// Hills on one half, a plain with a roof over a part of it on the other: places differ in what
/// they see and in how many items they have.
std::string hills(int side) {
    std::string text;
    const auto vertex = [&](double x, double y, double z) {
        text += fmt::format("v {:f} {:f} {:f}\n", x, y, z);
    };
    for (int i = 0; i <= side; ++i)
        for (int k = 0; k <= side; ++k) {
            const double x = 0.1 * i, z = 0.1 * k;
            vertex(x, 2 * i < side ? std::sin(2 * x) * std::sin(3 * z) : 0.0, z);
        }
    for (int i = 0; i < side; ++i)
        for (int k = 0; k < side; ++k) {
            const int a = i * (side + 1) + k + 1, b = a + side + 1;
            text += fmt::format("f {} {} {} {}\n", a, a + 1, b + 1, b);
        }
    const double end = 0.1 * side;
    vertex(0.7 * end, 1, 0);
    vertex(end, 1, 0);
    vertex(end, 1, end);
    vertex(0.7 * end, 1, end);
    return text + "f -4 -3 -2 -1\n";
}

class EstimateTest : public CliTest {
protected:
    EstimateTest() { folder_.write("hills.obj", hills(100)); }

    Json stats(const std::string& arguments) const {
        runWell("bake",
                "hills.obj --level 2 --rays 1 --stats stats.json --progress none " + arguments);
        return Json::parse(readBytes(path("stats.json")));
    }
};

TEST_F(EstimateTest, IsWithinAFifthOfTheBake) {
    const Json predicted = stats("--spacing 0.1 --estimate")["estimate"];
    EXPECT_EQ(files().size(), 6u) << "no cache is written";
    const Json baked = stats("--spacing 0.1 -o whole.vdb");
    EXPECT_LT(predicted["sampled"], 0.5);
    const auto ratio = [&](const char* name, const Json& wanted) {
        return predicted[name].get<double>() / wanted.get<double>();
    };
    EXPECT_NEAR(ratio("items", baked["cache"]["items"]), 1, 0.2);
    EXPECT_NEAR(ratio("rays", baked["rays"]["bake"]), 1, 0.2);
    EXPECT_NEAR(ratio("bytes", baked["cache"]["bytes"]), 1, 0.2);
    // Control: half the spacing is about four times as much.
    const Json finer = stats("--spacing 0.05 --estimate")["estimate"];
    for (const char* name : {"items", "rays", "bytes"})
        EXPECT_GT(finer[name].get<double>(), 2 * predicted[name].get<double>()) << name;
}

// Where there are few voxels, all of them are the sample. What a cache already holds is no part.
TEST_F(EstimateTest, OfFewVoxelsIsExact) {
    const Json predicted = stats("--spacing 0.5 --estimate")["estimate"];
    const Json baked = stats("--spacing 0.5 -o whole.vdb");
    EXPECT_EQ(predicted["sampled"], 1);
    EXPECT_EQ(predicted["items"], baked["cache"]["items"]);
    EXPECT_EQ(predicted["rays"], baked["rays"]["bake"]);
    EXPECT_EQ(stats("--extend whole.vdb --estimate")["estimate"]["items"], 0);
}

TEST_F(EstimateTest, NeedsNoOutputAndABakeDoes) {
    const auto refused = run("bake", "hills.obj");
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find("--output is required"), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace shadowcache::test
