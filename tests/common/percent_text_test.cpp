// Shares are printed in per cent without powers of ten.

#include "common/base/percent_text.h"

#include <gtest/gtest.h>

#include <limits>

namespace shadowcache {
namespace {

TEST(PercentText, HasNoPowerOfTen) {
    EXPECT_EQ(percentText(1, 2), "100 %");
    EXPECT_EQ(percentText(0.996, 2), "100 %");
    EXPECT_EQ(percentText(123.4, 2), "12340 %");
    EXPECT_EQ(percentText(1e-6, 2), "0.0001 %");
    EXPECT_EQ(percentText(std::numeric_limits<double>::max(), 2).find('e'), std::string::npos);
}

TEST(PercentText, HasTheDigitsThatSaySomething) {
    EXPECT_EQ(percentText(0, 3), "0 %");
    EXPECT_EQ(percentText(0.5, 3), "50 %");
    EXPECT_EQ(percentText(0.12345, 3), "12.3 %");
    EXPECT_EQ(percentText(0.0012345, 2), "0.12 %");
    EXPECT_EQ(percentText(0.09996, 2), "10 %");
    EXPECT_EQ(percentText(-0.25, 2), "-25 %");
}

}  // namespace
}  // namespace shadowcache
