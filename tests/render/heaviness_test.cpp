// From which heaviness on samples are reused: less where the frame has other errors anyway.

#include "render/cached/heaviness.h"

#include <gtest/gtest.h>

#include <cmath>

namespace shadowcache {
namespace {

/// All of the variance of samples this heavy, nine tenths of which reuse removes.
VarianceByHeaviness allAt(double heaviness, double variance) {
    VarianceByHeaviness found;
    found.add(heaviness, variance, variance / 10);
    return found;
}

TEST(Heaviness, OfAFrameWithoutOtherErrorsIsTheLeast) {
    EXPECT_EQ(allAt(0.1, 0.001).heavyFrom(0), kHeavy);
    EXPECT_EQ(VarianceByHeaviness().heavyFrom(0), kHeavy);
}

TEST(Heaviness, GrowsWithTheRootOfOtherErrors) {
    const double at = allAt(0.5, 1e-9).heavyFrom(0.02);
    EXPECT_GT(at, kHeavy);
    EXPECT_NEAR(allAt(0.5, 1e-9).heavyFrom(0.08), 2 * at, 1e-6);
}

// What is not reused is an error of its own, in which lighter samples are lost.
TEST(Heaviness, CountsTheErrorOfWhatIsNotReused) {
    const double alone = VarianceByHeaviness().heavyFrom(0.01);
    // Reused: a tenth is left.
    EXPECT_NEAR(allAt(0.9, 0.02).heavyFrom(0.01), alone * std::sqrt(1.2), 1e-9);
    // Not reused: all is left.
    EXPECT_NEAR(allAt(0.01, 0.02).heavyFrom(0.01), alone * std::sqrt(3), 1e-9);
}

// Unused, they leave an error in which they are lost; reused, one in which they are not.
TEST(Heaviness, OfTwoThatAgreeIsTheOneOfFewerRays) {
    const double unused = VarianceByHeaviness().heavyFrom(0.02);
    ASSERT_GT(unused, 0.06);
    ASSERT_LT(VarianceByHeaviness().heavyFrom(0.002), 0.06);
    EXPECT_NEAR(allAt(0.06, 0.02).heavyFrom(0), unused, 1e-9);
    // Control: heavy enough to be seen unused as well.
    EXPECT_LT(allAt(0.09, 0.02).heavyFrom(0), 0.06);
}

TEST(Heaviness, OfPlacesAddsUp) {
    VarianceByHeaviness frame, direct;
    frame.add(allAt(0.4, 0.01), 0.5, 0.25);
    direct.add(0.2, 0.00125, 0.000125);
    for (const double other : {0.0, 0.01, 0.2})
        EXPECT_DOUBLE_EQ(frame.heavyFrom(other), direct.heavyFrom(other));
    // Control: twice the variance.
    frame.add(allAt(0.4, 0.01), 0.5, 0.25);
    EXPECT_GT(frame.heavyFrom(0.01), direct.heavyFrom(0.01));
}

}  // namespace
}  // namespace shadowcache
