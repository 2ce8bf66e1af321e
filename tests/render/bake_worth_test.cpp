// What --explain says of a bake.

#include "render/app/bake_worth.h"

#include <gtest/gtest.h>

namespace shadowcache {
namespace {

bool says(const BakeWorth& worth, int frames, const char* words) {
    return textOf(worth, frames).find(words) != std::string::npos;
}

TEST(BakeWorth, SaysFromWhichFrameItPays) {
    BakeWorth worth;
    worth.bake.seconds = 70;
    worth.frameSeconds = 28;
    worth.withoutSeconds = 30;
    EXPECT_TRUE(says(worth, 34, "no bake for 34 frames: one pays from frame 35 on"));
    EXPECT_TRUE(says(worth, 50, "a bake: it pays from frame 35 on and saves 30 s"));
    worth.withoutSeconds = 500;
    EXPECT_TRUE(says(worth, 1, "a bake: it pays from frame 1 on"));
}

TEST(BakeWorth, SaysThatNonePays) {
    BakeWorth worth;
    worth.bake.seconds = 1;
    worth.frameSeconds = 28;
    worth.withoutSeconds = 27;
    EXPECT_TRUE(says(worth, 100000, "no bake: a frame takes no less with one"));
    worth.withoutSeconds = worth.frameSeconds;
    EXPECT_TRUE(says(worth, 100000, "no bake: a frame takes no less with one"));
}

}  // namespace
}  // namespace shadowcache
