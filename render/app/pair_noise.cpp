#include "render/app/pair_noise.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>

namespace shadowcache {

namespace {

/// Pixels darker than this share of the mean count as that bright, as relMSE has it.
constexpr double kDimmest = 0.1;

/// Pixels around one that its light is measured by.
constexpr int kRadius = 2;

/// Sum over the pixels of the squared difference of the two, over the square of their light.
/// Without light they may be alike since both miss it.
double differenceOf(const PicturePair& pair) {
    const double light =
        std::reduce(pair[0].begin(), pair[0].end()) + std::reduce(pair[1].begin(), pair[1].end());
    if (!(light > 0)) return std::numeric_limits<double>::max();
    return std::transform_reduce(pair[0].begin(), pair[0].end(), pair[1].begin(), 0.0, std::plus(),
                                 [](double x, double y) { return (x - y) * (x - y); }) /
           (light * light);
}

/// Weight of the mean of a pair beside that of another one.
double weightOf(double difference, double ofOther) {
    if (difference == ofOther) return 0.5;
    if (difference > ofOther) return 1 - weightOf(ofOther, difference);
    return 1 / (1 + difference / ofOther);
}

/// weight * a + (1 - weight) * b.
std::vector<double> mix(const std::vector<double>& a, const std::vector<double>& b, double weight) {
    std::vector<double> result(a.size());
    std::ranges::transform(a, b, result.begin(),
                           [&](double x, double y) { return weight * x + (1 - weight) * y; });
    return result;
}

/// Means over the pixels at most kRadius rows and columns away.
std::vector<double> blurred(const std::vector<double>& pixels, int width) {
    const int height = static_cast<int>(pixels.size()) / width;
    std::vector<double> result(pixels.size());
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const int left = std::max(0, x - kRadius), right = std::min(width - 1, x + kRadius);
            const int top = std::max(0, y - kRadius), bottom = std::min(height - 1, y + kRadius);
            double sum = 0;
            for (int v = top; v <= bottom; ++v)
                for (int u = left; u <= right; ++u) sum += pixels[at(u, v)];
            result[at(x, y)] = sum / ((right - left + 1) * (bottom - top + 1));
        }
    return result;
}

}  // namespace

std::array<double, 2> noiseOfPairs(const PicturePair& a, const PicturePair& b, int width) {
    const std::array<const PicturePair*, 2> pairs{&a, &b};
    const auto lightOf = [&](const PicturePair& pair) {
        return blurred(mix(pair[0], pair[1], 0.5), width);
    };
    const std::array<std::vector<double>, 2> lights{lightOf(a), lightOf(b)};
    const std::vector<double> light =
        mix(lights[0], lights[1], weightOf(differenceOf(a), differenceOf(b)));
    const auto pixels = static_cast<double>(light.size());
    const double mean = std::reduce(light.begin(), light.end()) / pixels;
    const double dark = std::max(1e-30, kDimmest * mean);
    std::array<double, 2> noise{};
    for (std::size_t i = 0; i < light.size(); ++i) {
        const double scale = light[i] * light[i] + dark * dark;
        for (const std::size_t k : {0u, 1u}) {
            const double apart = (*pairs[k])[0][i] - (*pairs[k])[1][i];
            const double off = lights[k][i] - light[i];
            noise[k] += (apart * apart / 2 + off * off) / (scale * pixels);
        }
    }
    return noise;
}

}  // namespace shadowcache
