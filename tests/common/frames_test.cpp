// Frames below zero; which `#` of a name is a frame's number.

#include "common/shot/frames.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace shadowcache::test {
namespace {

TEST(Frames, MayBeBelowZero) {
    EXPECT_EQ(parseFrames("-3--1,2"), (std::vector<int>{-3, -2, -1, 2}));
    EXPECT_EQ(parseFrames("-4-4x4"), (std::vector<int>{-4, 0, 4}));
    EXPECT_EQ(parseFrames("-7"), std::vector<int>{-7});
    for (const char* bad : {"-1--3", "--1", "1-", "-", "1-3x-1", "1--3"})
        expectError([&] { parseFrames(bad); }, bad, "expected A, A-B or A-BxSTEP");
}

TEST(Frames, HaveTheirNumbersInNames) {
    const auto name = [](const std::string& pattern, int frame, FrameNames names) {
        return framePath("some#where/" + pattern, frame, names).string().substr(11);
    };
    for (const FrameNames names : {FrameNames::one, FrameNames::several}) {
        EXPECT_EQ(name("a.####.exr", 12, names), "a.0012.exr");
        EXPECT_EQ(name("a.####.exr", -12, names), "a.-0012.exr");
        EXPECT_EQ(name("a.%04d.exr", -12, names), "a.-012.exr");
        EXPECT_EQ(name("a.##.exr", 12345, names), "a.12345.exr");
        EXPECT_EQ(name("take#2.####.exr", 7, names), "take#2.0007.exr");
        EXPECT_EQ(name("take#2.exr", 7, names), "take72.exr");
        EXPECT_EQ(name("####", 7, names), "0007");
        EXPECT_EQ(name("a%d.exr", 7, names), "a7.exr");
    }
    EXPECT_EQ(name("plain.exr", 7, FrameNames::one), "plain.exr");
    expectError([&] { name("plain.exr", 7, FrameNames::several); }, "plain.exr",
                "expected a frame number in the name");
}

TEST(Frames, ThatNobodyAskedForLeaveASingleSign) {
    const auto name = [](const std::string& pattern) {
        return framePath(pattern, 1, FrameNames::unasked).string();
    };
    EXPECT_EQ(name("take#2.exr"), "take#2.exr");
    EXPECT_EQ(name("50%d.exr"), "50%d.exr");
    EXPECT_EQ(name("a.####.exr"), "a.0001.exr");
    EXPECT_EQ(name("a.%03d.exr"), "a.001.exr");
    EXPECT_EQ(name("plain.exr"), "plain.exr");
}

}  // namespace
}  // namespace shadowcache::test
