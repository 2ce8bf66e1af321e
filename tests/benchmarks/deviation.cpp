#include "tests/benchmarks/deviation.h"

#include <algorithm>
#include <cmath>

namespace shadowcache::bench {

void Deviation::add(const Image& image, const Image& reference, double scale) {
    const auto green = [](const Rgb& p) { return static_cast<double>(p.y); };
    double mean = 0;
    for (const Rgb& p : reference.pixels) mean += green(p);
    mean *= scale / static_cast<double>(reference.pixels.size());
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const double wanted = scale * green(reference.pixels[i]);
        const double d = (green(image.pixels[i]) - wanted) / (std::abs(wanted) + 0.1 * mean);
        sum += d;
        squares += d * d;
        ++count;
    }
}

double Deviation::significance() const {
    return sum / std::sqrt(std::max(squares - sum * sum / count, 1e-300));
}

}  // namespace shadowcache::bench
