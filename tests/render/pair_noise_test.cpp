// Noise of two pairs of pictures against that which they were made with.

#include "render/app/pair_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace shadowcache {
namespace {

constexpr int kPictureWidth = 80, kPictureHeight = 60;

/// Two pictures of light 1 in which a part `lit` of the pixels has all of it.
PicturePair pairOf(double lit, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    PicturePair pair;
    for (auto& pixels : pair)
        for (int i = 0; i < kPictureWidth * kPictureHeight; ++i)
            pixels.push_back(unit(random) < lit ? 1 / lit : 0);
    return pair;
}

// The variance of light 1/p with probability p is 1/p - 1, relative to the squared light and a
// hundredth.
TEST(PairNoise, IsTheVarianceThatPicturesWereMadeWith) {
    const auto [few, many] = noiseOfPairs(pairOf(0.05, 1), pairOf(0.5, 2), kPictureWidth);
    EXPECT_NEAR(many, 1 / 1.01, 0.15);
    EXPECT_NEAR(few, 19 / 1.01, 3);
}

// Of a single bright pixel by itself, relMSE is at most 8 by a mean of four, however bright it is.
TEST(PairNoise, GrowsWithFireflies) {
    const PicturePair smooth = pairOf(1, 1);
    PicturePair one = smooth, ten = smooth;
    one[0][2000] = 1e3;
    ten[0][2000] = 1e4;
    const double pixels = kPictureWidth * kPictureHeight;
    EXPECT_NEAR(noiseOfPairs(smooth, one, kPictureWidth)[1], 0.5e6 / pixels, 0.1e6 / pixels);
    EXPECT_NEAR(noiseOfPairs(ten, smooth, kPictureWidth)[0], 0.5e8 / pixels, 0.1e8 / pixels);
    EXPECT_EQ(noiseOfPairs(smooth, one, kPictureWidth)[0], 0);
}

TEST(PairNoise, IsNotNoneOfPicturesThatBothMissTheLight) {
    const PicturePair dark{std::vector<double>(kPictureWidth * kPictureHeight, 0.0),
                           std::vector<double>(kPictureWidth * kPictureHeight, 0.0)};
    const auto [lit, missing] = noiseOfPairs(pairOf(0.05, 3), dark, kPictureWidth);
    EXPECT_GT(missing, 0.5);
    EXPECT_GT(lit, 0.5);
    EXPECT_EQ(noiseOfPairs(dark, dark, kPictureWidth)[0], 0) << "where there is none";
}

}  // namespace
}  // namespace shadowcache
