// The intended word is found, and none where nothing is near.

#include "common/base/suggestion.h"

#include <gtest/gtest.h>

#include <vector>

namespace shadowcache {
namespace {

const std::vector<std::string> kWords{"--samples", "--spacing", "--scale", "--env", "--env-rotate"};

TEST(Suggestion, FindsTheWordThatWasMeant) {
    EXPECT_EQ(nearestWord("--sample", kWords), "--samples");
    EXPECT_EQ(nearestWord("--smaples", kWords), "--samples");
    EXPECT_EQ(nearestWord("--scal", kWords), "--scale");
    EXPECT_EQ(nearestWord("--env-ro", kWords), "--env-rotate");
    EXPECT_EQ(nearestWord("--enf", kWords), "--env");
    EXPECT_EQ(suggestion("--sample", kWords), ", did you mean --samples?");
}

TEST(Suggestion, SaysNothingWhereNothingIsNear) {
    EXPECT_EQ(nearestWord("--threshold", kWords), "");
    EXPECT_EQ(nearestWord("xy", kWords), "");
    EXPECT_EQ(nearestWord("", kWords), "");
    EXPECT_EQ(nearestWord("--sample", {}), "");
    EXPECT_EQ(suggestion("--threshold", kWords), "");
}

}  // namespace
}  // namespace shadowcache
