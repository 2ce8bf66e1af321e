// Importance from a low-resolution map of equal rectangles in polar angle and longitude. [paper
// 6.2] As printed, a rectangle whose middle is below the horizon is never sampled; `pixel` bounds
// the cosine over each rectangle from above, so that all of the hemisphere is.

#include <algorithm>
#include <cmath>

#include "common/base/option_checks.h"
#include "render/estimators/full_precision.h"
#include "tests/study/estimators/makers.h"

namespace shadowcache::study {

namespace {

/// A rectangle of the low-resolution map.
struct MapPixel {
    Vec3f middle;
    double luminance;  ///< mean over the rectangle, positive wherever some of it is lit
    double area;       ///< [sr]
    double sine;       ///< of the angle around the middle that holds it
};

struct PixelWorkspace final : Workspace {
    std::vector<double> cdf;
};

class PixelImportance final : public PointEstimator {
public:
    PixelImportance(const EstimatorContext& context, const PixelOptions& options, bool printed)
        : PointEstimator(context),
          printed_(printed),
          width_(static_cast<std::size_t>(options.width)),
          height_(static_cast<std::size_t>(options.height)),
          pixels_(width_ * height_) {
        std::vector<double> luminanceIntegral(pixels_.size()), area(pixels_.size());
        for (std::size_t i = 0; i < context.environment.texelCount(); ++i)
            addTexel(context.environment, i, luminanceIntegral, area);
        for (std::size_t k = 0; k < pixels_.size(); ++k) {
            pixels_[k] = rectangle(k);
            const double mean = area[k] > 0 ? luminanceIntegral[k] / area[k] : 0;
            pixels_[k].luminance = std::max(mean, leastLuminance(pixels_[k]));
        }
    }

    std::unique_ptr<Workspace> makeWorkspace() const override {
        return std::make_unique<PixelWorkspace>();
    }

private:
    static constexpr int kSubdivisions = 8;  ///< along a side of a bright texel
    bool printed_;
    std::size_t width_, height_;
    std::vector<MapPixel> pixels_;

    /// Shares a texel out among the rectangles that it lies in, by points that stand on its sides,
    /// too; one no brighter than the map is in the mean goes to that of its middle.
    void addTexel(const Environment& environment, std::size_t i,
                  std::vector<double>& luminanceIntegral, std::vector<double>& area) const {
        const Environment::Texel t = environment.texel(i);
        const auto luminance = static_cast<double>(environment.luminance(t.radiance));
        const auto solidAngle = static_cast<double>(t.solidAngle);
        const auto add = [&](std::size_t k, double share) {
            area[k] += share;
            luminanceIntegral[k] += share * luminance;
        };
        if (luminance <= environment.luminanceIntegral() / (4 * kPi))
            return add(pixelAlong(Vec3d(t.center)), solidAngle);
        const int n = kSubdivisions;
        for (int y = 0; y <= n; ++y)
            for (int x = 0; x <= n; ++x)
                add(pixelAlong(environment.placeIn(i, static_cast<double>(x) / n,
                                                   static_cast<double>(y) / n)),
                    solidAngle * (x % n == 0 ? 0.5 : 1.0) * (y % n == 0 ? 0.5 : 1.0) / (n * n));
    }

    std::size_t pixelAlong(const Vec3d& w) const {
        const double turn = std::atan2(w.x, w.z) / (2 * kPi);
        const double polar = std::acos(std::clamp(w.y, -1.0, 1.0)) / kPi;
        const auto x =
            static_cast<std::size_t>((turn - std::floor(turn)) * static_cast<double>(width_));
        const auto y = static_cast<std::size_t>(polar * static_cast<double>(height_));
        return std::min(y, height_ - 1) * width_ + std::min(x, width_ - 1);
    }

    /// Place (s, t) in [0, 1)^2 of rectangle k, uniform in solid angle.
    Vec3d place(std::size_t k, double s, double t) const {
        const std::size_t row = k / width_;
        const auto x = static_cast<double>(k % width_), y = static_cast<double>(row);
        const auto w = static_cast<double>(width_), h = static_cast<double>(height_);
        const double top = std::cos(kPi * y / h), bottom = std::cos(kPi * (y + 1) / h);
        const double cosPolar = top + (bottom - top) * t;
        const double sinPolar = std::sqrt(std::max(0.0, 1 - cosPolar * cosPolar));
        const double longitude = 2 * kPi * (x + s) / w;
        return {sinPolar * std::sin(longitude), cosPolar, sinPolar * std::cos(longitude)};
    }

    MapPixel rectangle(std::size_t k) const {
        const auto w = static_cast<double>(width_), h = static_cast<double>(height_);
        const std::size_t row = k / width_;
        const auto y = static_cast<double>(row);
        const double polar = kPi * (y + 0.5) / h,
                     longitude = 2 * kPi * (static_cast<double>(k % width_) + 0.5) / w;
        const Vec3d middle(std::sin(polar) * std::sin(longitude), std::cos(polar),
                           std::sin(polar) * std::cos(longitude));
        // The printed approximation of the solid angle is exact as rectangles become small.
        const double area =
            printed_ ? 2 * kPi * kPi * std::sin(polar) / (w * h)
                     : 2 * kPi / w * (std::cos(kPi * y / h) - std::cos(kPi * (y + 1) / h));
        double least = 1;
        for (const double s : {0.0, 1.0})
            for (const double t : {0.0, 1.0}) least = std::min(least, middle.dot(place(k, s, t)));
        return {Vec3f(middle), 0, area, std::sqrt(std::max(0.0, 1 - least * least)) + 1e-6};
    }

    /// As if a part of the brightest texel nearby were in it: the density is positive wherever
    /// there is light, also where the points of addTexel missed it.
    double leastLuminance(const MapPixel& pixel) const {
        if (printed_) return 0;
        const Environment& e = context_.environment;
        const double part =
            2 * kPi * kPi / static_cast<double>(e.texelCount()) / (kSubdivisions * kSubdivisions);
        const double angle = std::asin(std::min(1.0, pixel.sine));
        return static_cast<double>(e.maxLuminance(Vec3d(pixel.middle), angle)) * part / pixel.area;
    }

    /// What stands for the cosine over a rectangle.
    double cosineOf(const MapPixel& pixel, const Vec3f& n) const {
        const auto height = static_cast<double>(n.dot(pixel.middle));
        if (printed_ || height >= pixel.sine) return std::max(0.0, height);
        return std::max(0.0, (height + pixel.sine) / 2);
    }

    Rgb prepare(const ShadingPoint& point, const SampleSlice& slice,
                Workspace& workspace) const override {
        auto& w = static_cast<PixelWorkspace&>(workspace);
        w.cdf.resize(pixels_.size());
        double total = 0;
        for (std::size_t k = 0; k < pixels_.size(); ++k) {
            const MapPixel& pixel = pixels_[k];
            w.cdf[k] = total += cosineOf(pixel, point.place.normal) * pixel.luminance * pixel.area;
        }
        if (!(total > 0)) return {0, 0, 0};
        const auto u = w.numbers(context_.sequence, point.slot.seed, 0, slice.first, slice.count);
        const auto v = w.numbers(context_.sequence, point.slot.seed, 1, slice.first, slice.count);
        for (std::size_t j = 0; j < u.size(); ++j) {
            const double x = fullPrecision(u[j], point.slot.seed, slice.first + j) * total;
            auto k = static_cast<std::size_t>(std::upper_bound(w.cdf.begin(), w.cdf.end(), x) -
                                              w.cdf.begin());
            k = std::min(k, pixels_.size() - 1);
            const double before = k > 0 ? w.cdf[k - 1] : 0, mass = w.cdf[k] - before;
            if (mass > 0)
                addSample(point, k, std::clamp((x - before) / mass, 0.0, 1.0),
                          static_cast<double>(toUnitFloat(v[j])),
                          mass / (total * pixels_[k].area) * slice.count, w);
            else
                w.samples.addZero();
        }
        w.samples.endGroup();
        return {0, 0, 0};
    }

    void addSample(const ShadingPoint& point, std::size_t k, double s, double t, double density,
                   Workspace& w) const {
        const Vec3f direction(place(k, s, t));
        const float cosine = direction.dot(point.place.normal);
        if (cosine > 0)
            w.samples.add(direction, context_.environment.radiance(direction) *
                                         (cosine / static_cast<float>(density)));
        else
            w.samples.addZero();
    }
};

}  // namespace

void validate(const PixelOptions& options) {
    requireRange("pixel-map (width)", options.width, 8, 4096);
    requireRange("pixel-map (height)", options.height, 4, 2048);
}

std::unique_ptr<Estimator> makePixel(const EstimatorContext& context, const PixelOptions& options) {
    return std::make_unique<PixelImportance>(context, options, false);
}
std::unique_ptr<Estimator> makePixelPrinted(const EstimatorContext& context,
                                            const PixelOptions& options) {
    return std::make_unique<PixelImportance>(context, options, true);
}

}  // namespace shadowcache::study
