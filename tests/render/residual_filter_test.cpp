// What the filter of a preview's residuals keeps and what it smooths, on images with known answers.

#include "render/frame/residual_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "common/base/hash.h"
#include "common/base/parallel.h"

namespace shadowcache {
namespace {

const Rgb kLuminance(0.2126f, 0.7152f, 0.0722f);
constexpr int kWidth = 75, kHeight = 50;  // no multiple of any vector's length

/// A wall at z = 0 that fills the image; a pixel is 0.01 wide.
ResidualImage wall(const std::function<Rgb(int, int)>& residual, float variance) {
    ResidualImage image{kWidth, kHeight, {}};
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            image.pixels.push_back(
                {residual(x, y),
                 variance,
                 {0, 0, 1},
                 {0.01f * static_cast<float>(x), 0.01f * static_cast<float>(y), 0},
                 0.01f});
    return image;
}

ResidualImage filtered(ResidualImage image) {
    filterResiduals(image, kLuminance);
    return image;
}

const ResidualPixel& at(const ResidualImage& image, int x, int y) {
    return image.pixels[static_cast<std::size_t>(y * image.width + x)];
}

/// Normal deviate of a pixel, by a sum of uniform ones.
float noise(int x, int y, std::uint64_t seed) {
    double sum = -6;
    for (std::uint64_t k = 0; k < 12; ++k)
        sum += toUnit(
            hashWords(seed * 16 + k, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
    return static_cast<float>(sum);
}

double meanSquare(const ResidualImage& a, const std::function<Rgb(int, int)>& truth) {
    double sum = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float error = (at(a, x, y).residual - truth(x, y)).dot(kLuminance);
            sum += static_cast<double>(error * error) / (kWidth * kHeight);
        }
    return sum;
}

Rgb zero(int, int) {
    return {0, 0, 0};
}
Rgb white(int x, int y, float deviation, std::uint64_t seed) {
    return Rgb(1, 1, 1) * (deviation * noise(x, y, seed));
}

TEST(ResidualFilter, KeepsAConstant) {
    const Rgb color(0.3f, -0.5f, 7);
    const ResidualImage image = filtered(wall([&](int, int) { return color; }, 0.2f));
    for (const ResidualPixel& pixel : image.pixels) {
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(pixel.residual[k], color[k], 3e-6f);
        EXPECT_LT(pixel.variance, 0.2f / 20);
    }
}

TEST(ResidualFilter, KeepsEveryPixelWithoutVariance) {
    const auto residual = [](int x, int y) { return white(x, y, 0.1f, 1); };
    EXPECT_LT(meanSquare(filtered(wall(residual, 0)), residual), 1e-18);
    // Control: variance lets it smooth.
    EXPECT_GT(meanSquare(filtered(wall(residual, 0.01f)), residual), 1e-3);
}

TEST(ResidualFilter, SmoothsNoise) {
    const auto residual = [](int x, int y) { return white(x, y, 0.1f, 2); };
    const ResidualImage image = filtered(wall(residual, 0.01f));
    const double left = meanSquare(image, zero);
    EXPECT_LT(left, 0.01 / 40);
    // It is what the filter says, though weights that follow the noise leave more.
    double told = 0;
    for (const ResidualPixel& pixel : image.pixels)
        told += static_cast<double>(pixel.variance) / (kWidth * kHeight);
    EXPECT_GT(told, left / 3);
    EXPECT_LT(told, left * 1.2);
}

TEST(ResidualFilter, KnowsTheVarianceThatIsLeft) {
    // Noise far below the variance told: all weights are those of the kernel, a triangle of side 16
    // whose squares sum to (2 16^2 + 1) / (3 16^3) along each axis.
    const double side = (2 * 256 + 1) / (3.0 * 4096);
    const ResidualImage image = filtered(wall(zero, 1));
    EXPECT_NEAR(static_cast<double>(at(image, kWidth / 2, kHeight / 2).variance), side * side,
                1e-5);
}

/// Greatest residual on the left of an image whose right half alone has any.
float leak(const std::function<void(ResidualPixel&)>& changeRight) {
    constexpr int kEdge = 37;
    ResidualImage image =
        wall([](int x, int) { return Rgb(1, 1, 1) * (x < kEdge ? 0.f : 1.f); }, 1);
    for (int y = 0; y < kHeight; ++y)
        for (int x = kEdge; x < kWidth; ++x)
            changeRight(image.pixels[static_cast<std::size_t>(y * kWidth + x)]);
    filterResiduals(image, kLuminance);
    float most = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kEdge; ++x) most = std::max(most, at(image, x, y).residual.x);
    return most;
}

TEST(ResidualFilter, CrossesNoEdge) {
    const float angle = 0.7f;
    EXPECT_EQ(leak([&](ResidualPixel& p) { p.normal = {std::sin(angle), 0, std::cos(angle)}; }), 0);
    EXPECT_EQ(leak([](ResidualPixel& p) { p.position.z -= 0.5f; }), 0);
    EXPECT_EQ(leak([](ResidualPixel& p) { p.width = 0; }), 0);
    // Controls: nothing there, a slight bend, a step far below a pixel's width.
    EXPECT_GT(leak([](ResidualPixel&) {}), 0.2f);
    EXPECT_GT(leak([](ResidualPixel& p) { p.normal = Vec3f(0.1f, 0, 1).normalized(); }), 0.2f);
    EXPECT_GT(leak([](ResidualPixel& p) { p.position.z -= 0.001f; }), 0.2f);
}

TEST(ResidualFilter, LeavesPixelsWithoutASurface) {
    ResidualImage image = wall([](int x, int y) { return white(x, y, 1, 3); }, 1);
    for (ResidualPixel& pixel : image.pixels) pixel.width = 0;
    const ResidualImage same = filtered(image);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        EXPECT_EQ(same.pixels[i].residual, image.pixels[i].residual);
}

TEST(ResidualFilter, IsConsistent) {
    // A step that no guide knows, and something smooth.
    const auto truth = [](int x, int y) {
        return Rgb(1, 1, 1) *
               ((x + y > 60 ? 0.3f : 0.f) + 0.1f * std::sin(0.2f * static_cast<float>(x)));
    };
    const auto error = [&](float variance, float told) {
        return meanSquare(
            filtered(wall(
                [&](int x, int y) { return truth(x, y) + white(x, y, std::sqrt(variance), 4); },
                told)),
            truth);
    };
    double before = 1;
    for (const float variance : {0.1f, 1e-2f, 1e-3f, 1e-4f, 1e-5f}) {
        const double now = error(variance, variance);
        EXPECT_LT(now, before / 2) << variance;
        EXPECT_LT(now, static_cast<double>(variance)) << variance;
        before = now;
    }
    // Control: a filter that is told of more noise than there is keeps its bias.
    EXPECT_GT(error(1e-5f, 0.1f), 1e-3);
}

TEST(ResidualFilter, HasTheSameBitsForAnyThreadsAndForAPart) {
    ResidualImage whole = wall([](int x, int y) { return white(x, y, 0.3f, 5); }, 0.1f);
    for (ResidualPixel& pixel : whole.pixels) pixel.variance *= std::abs(pixel.residual.x);
    setThreadCount(1);
    const ResidualImage one = filtered(whole);
    setThreadCount(0);
    const ResidualImage all = filtered(whole);
    const auto differences = [&](const ResidualImage& image, int left, int top, int margin) {
        int different = 0;
        for (int y = margin; y < image.height; ++y)
            for (int x = margin; x < image.width; ++x) {
                const ResidualPixel &a = at(image, x, y), &b = at(one, x + left, y + top);
                different += a.residual != b.residual || a.variance != b.variance;
            }
        return different;
    };
    EXPECT_EQ(differences(all, 0, 0, 0), 0);
    constexpr int kLeft = 9, kTop = 5;
    ResidualImage part{kWidth - kLeft, kHeight - kTop, {}};
    for (int y = kTop; y < kHeight; ++y)
        for (int x = kLeft; x < kWidth; ++x) part.pixels.push_back(at(whole, x, y));
    filterResiduals(part, kLuminance);
    EXPECT_EQ(differences(part, kLeft, kTop, kResidualReach), 0);
    // Control: nearer to the cut there are differences.
    EXPECT_GT(differences(part, kLeft, kTop, kResidualReach - 1), 0);
}

}  // namespace
}  // namespace shadowcache
