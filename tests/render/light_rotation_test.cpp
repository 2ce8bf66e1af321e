// Angles, matrices and reflections of `--env-rotate` agree; what is not orthogonal is refused
// with the value; turns and gains of a plan.

#include "render/shot/light_rotation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/number_text.h"
#include "render/shot/light_plan.h"
#include "tests/support/test_scenes.h"

namespace shadowcache {
namespace {

Turn turnOf(const std::string& text) {
    return parseRotation(text).first.turn();
}

void expectNear(const Turn& a, const Turn& b) {
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_LT((a.axis[k] - b.axis[k]).length(), 1e-12) << a.axis[k] << b.axis[k];
}

/// The nine numbers, row by row.
std::string matrixText(const Turn& turn) {
    std::string text;
    for (int row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            text += (text.empty() ? "" : ",") + numberText(turn.axis[column][row]);
    return text;
}

TEST(LightRotation, AnglesAndMatricesAgree) {
    EXPECT_EQ(turnOf("33.3"), turnOf("0,33.3,0"));
    expectNear(turnOf("33.3"), turnOf(matrixText(turnOf("33.3"))));
    expectNear(turnOf("10,-20,200"), turnOf(matrixText(turnOf("10,-20,200"))));
    EXPECT_EQ(turnOf("0"), turnOf("1,0,0,0,1,0,0,0,1"));
    // Control: another angle is another turn.
    EXPECT_GT((turnOf("33.3").axis[0] - turnOf("34.3").axis[0]).length(), 0.01);
}

TEST(LightRotation, AMatrixMayReflectAndIsMadeOrthogonal) {
    const Turn mirror = turnOf("-1,0,0,0,1,0,0,0,1");
    EXPECT_EQ(mirror.axis[0], Vec3d(-1, 0, 0));
    EXPECT_EQ(mirror.axis[1], Vec3d(0, 1, 0));
    EXPECT_EQ(mirror.axis[2], Vec3d(0, 0, 1));
    const Turn rounded = turnOf("0.70711,0,0.70711,0,-1,0,-0.70711,0,0.70711");
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            EXPECT_NEAR(rounded.axis[i].dot(rounded.axis[j]), i == j ? 1 : 0, 1e-14);
    EXPECT_NEAR(rounded.axis[0].cross(rounded.axis[1]).dot(rounded.axis[2]), -1, 1e-14);
}

TEST(LightRotation, RefusesWhatIsNoRotation) {
    const auto refused = [](const char* text, const char* cause) {
        test::expectError([&] { parseRotation(text); }, std::string("--env-rotate ") + text, cause);
    };
    refused("", "expected degrees");
    refused("1,2", "2 parts");
    refused("1,2,3,4", "4 parts");
    refused("1,x,3", "3 parts");
    refused("1,2,3,", "4 parts");
    refused("nan,0,0", "3 parts");
    refused("1,0,0,0,2,0,0,0,1", "row 2 has the length 2");
    refused("1,0,0,0.5,0.866025403784,0,0,0,1", "row 1 times row 2 is 0.5");
    refused("0,0,0,0,0,0,0,0,0", "row 1 has the length 0");
}

TEST(LightPlan, TurnsOverItsFramesAndKeepsItsGain) {
    const int frames[] = {1, 2, 3};
    const LightPlan plan({"1,1,1", "10-30", "2,0.5,0"}, frames);
    EXPECT_EQ(plan.at(1).rotation.text(), "20");
    EXPECT_EQ(plan.at(2).rotation.text(), "30");
    EXPECT_EQ(plan.at(0).gain, Vec3d(2, 0.5, 0));
    EXPECT_EQ(LightPlan({"1,1,1", "1,2,3", "4"}, frames).at(2).gain, Vec3d(4, 4, 4));
    EXPECT_EQ(LightPlan({"1,1,1", "1,2,3", "4"}, frames).at(2).rotation.text(), "1,2,3");
    for (const char* gain : {"", "-1", "1,2", "nan", "1,inf,1", "x", "1e7"})
        test::expectError(
            [&] {
                LightPlan({"1,1,1", "0", gain}, frames);
            },
            std::string("--env-gain ") + gain, "expected a factor");
}

}  // namespace
}  // namespace shadowcache
