#include "render/frame/pixel_filter.h"

#include <algorithm>
#include <cmath>

namespace shadowcache {

namespace {

double widthOf(FilterKind kind, double width) {
    if (width > 0) return width;
    return kind == FilterKind::box ? 1.0 : 1.5;
}

double radiusOf(FilterKind kind, double width) {
    const double scale = kind == FilterKind::box ? 1 : kind == FilterKind::gaussian ? 3 : 2;
    return 0.5 * scale * widthOf(kind, width);
}

}  // namespace

double filterValue(FilterKind kind, double width, double distance) {
    const double x = std::abs(distance) / radiusOf(kind, width);
    if (x >= 1) return 0;
    if (kind == FilterKind::box) return 1;
    if (kind == FilterKind::gaussian) return std::exp(-18 * x * x);
    // [Harris 1978, four terms]
    const double v = kPi * (x + 1);
    return 0.35875 - 0.48829 * std::cos(v) + 0.14128 * std::cos(2 * v) - 0.01168 * std::cos(3 * v);
}

PixelFilter::PixelFilter(FilterKind kind, double width)
    : box_(kind == FilterKind::box), radius_(radiusOf(kind, width)) {
    for (std::size_t i = 0; i < kSteps; ++i)
        cdf_[i + 1] =
            cdf_[i] + filterValue(kind, width, radius_ * (static_cast<double>(i) + 0.5) / kSteps);
    const double total = cdf_.back();
    for (double& value : cdf_) value /= total;
    std::uint16_t above = 1;
    for (std::size_t i = 0; i < kSteps; ++i) {
        while (above < kSteps && cdf_[above] <= static_cast<double>(i) / kSteps) ++above;
        guide_[i] = above;
    }
}

double PixelFilter::offset(double u) const {
    const double x = 2 * u - 1;
    if (box_) return radius_ * x;
    const double share = std::abs(x);
    std::size_t above = guide_[std::min(static_cast<std::size_t>(share * kSteps), kSteps - 1)];
    while (above < kSteps && cdf_[above] <= share) ++above;
    const double low = cdf_[above - 1], step = cdf_[above] - low;
    const double place = static_cast<double>(above - 1) + (step > 0 ? (share - low) / step : 0.0);
    return std::copysign(radius_ * std::min(1.0, place / kSteps), x);
}

}  // namespace shadowcache
