#include "render/frame/residual_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "common/base/parallel.h"
#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Passes over the residuals; the taps of each lie twice as far apart as those of the one before.
constexpr int kPasses = 4;
/// Passes over the variances before, which a few samples tell badly.
constexpr int kVariancePasses = 2;
static_assert(kResidualReach == (1 << kPasses) - 1 + (1 << kVariancePasses) - 1);

/// Difference of residuals, in standard deviations, at which a neighbour counts half.
SHADOWCACHE_TUNED(float, kResidualDeviations, 2);

/// 1 - cosine of the angle between normals from which on a neighbour does not count: 32 degrees.
SHADOWCACHE_TUNED(float, kMostNormalDifference, 0.15f);

/// Height over the plane of a pixel, in pixels for each pixel of distance, from which on a
/// neighbour does not count.
SHADOWCACHE_TUNED(float, kMostHeight, 1);

/// Mean correlation of the taps of a pass, whose pixels were averaged by those before: makes the
/// variance exact where all weights are those of the kernel, a triangle of side 2^(pass + 1).
constexpr float kCorrelation[kPasses] = {0, 0.0808f, 0.1141f, 0.1240f};

/// Less than any variance that matters, so that 0 / 0 does not arise.
constexpr float kNoVariance = 1e-30f;

/// Pixels that are filtered together: one code for all of them, so that a pixel's bits do not
/// depend on where a row begins.
constexpr int kLanes = 16;

/// Rows that one thread takes at a time.
constexpr std::size_t kRowsOfChunk = 8;

/// Where pixels are in a plane of numbers: with a border of pixels without a surface, so that no
/// tap needs to know where the image ends.
class Layout {
public:
    Layout(int width, int height)
        : blocks_((width + kLanes - 1) / kLanes),
          stride_((blocks_ + 2) * kLanes),
          rows_(height),
          size_(static_cast<std::size_t>(stride_) *
                static_cast<std::size_t>(height + 2 * kBorder)) {}

    int blocks() const { return blocks_; }
    int rows() const { return rows_; }
    std::ptrdiff_t stride() const { return stride_; }
    std::size_t size() const { return size_; }
    std::ptrdiff_t indexOf(int x, int y) const {
        return static_cast<std::ptrdiff_t>(y + kBorder) * stride_ + x + kLanes;
    }

private:
    static constexpr int kBorder = 1 << (kPasses - 1);
    static_assert(kBorder <= kLanes);
    int blocks_, stride_, rows_;
    std::size_t size_;
};

using Plane = std::vector<float>;

/// What is filtered.
struct Values {
    std::array<Plane, 3> residual;
    Plane variance;

    explicit Values(std::size_t size) : variance(size) {
        for (Plane& plane : residual) plane.resize(size);
    }
};

/// By what neighbours are judged.
struct FilterGuides {
    std::array<Plane, 3> normal, position;
    Plane height;  ///< greatest over the plane of the pixel, for each pixel of distance

    explicit FilterGuides(std::size_t size) : height(size) {
        for (Plane& plane : normal) plane.resize(size);
        for (Plane& plane : position) plane.resize(size);
    }
};

/// A neighbour of each pixel.
struct Tap {
    std::ptrdiff_t offset;
    float kernel;
    float distance;  ///< in pixels, at least 1
};

std::array<Tap, 9> tapsOf(const Layout& layout, int step) {
    constexpr float kKernel[2] = {0.5f, 0.25f};
    std::array<Tap, 9> taps;
    std::size_t i = 0;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
            taps[i++] = {(dy * layout.stride() + dx) * step,
                         kKernel[std::abs(dx)] * kKernel[std::abs(dy)],
                         std::max(1.0f, static_cast<float>(step) *
                                            std::sqrt(static_cast<float>(dx * dx + dy * dy)))};
    return taps;
}

/// kLanes numbers, each of a pixel of its own.
struct alignas(64) Lanes {
    float value[kLanes] = {};
};

/// How far the neighbours at `tap` of the pixels from `p` on lie on the same surface.
void matchSurfaces(const FilterGuides& guides, std::ptrdiff_t p, const Tap& tap, Lanes& weight) {
    const std::ptrdiff_t q = p + tap.offset;
    const float *nx = guides.normal[0].data(), *ny = guides.normal[1].data(),
                *nz = guides.normal[2].data();
    const float *px = guides.position[0].data(), *py = guides.position[1].data(),
                *pz = guides.position[2].data();
    const float* most = guides.height.data() + p;
    for (int i = 0; i < kLanes; ++i) {
        const float x = nx[p + i], y = ny[p + i], z = nz[p + i];
        const float cosine = x * nx[q + i] + y * ny[q + i] + z * nz[q + i];
        const float turn = (1 - cosine) * (1 / kMostNormalDifference);
        const float alike = turn < 1 ? 1 - turn : 0;
        const float height =
            x * (px[q + i] - px[p + i]) + y * (py[q + i] - py[p + i]) + z * (pz[q + i] - pz[p + i]);
        // Without a surface this is 0 / 0, which is not below 1.
        const float off = height / (most[i] * tap.distance);
        const float flat = off * off < 1 ? 1 - off * off : 0;
        weight.value[i] = tap.kernel * alike * alike * flat * flat;
    }
}

/// The mean variance of the neighbours on the same surface.
void smoothVariances(const FilterGuides& guides, const Values& from, std::span<const Tap> taps,
                     std::ptrdiff_t p, Values& to) {
    Lanes sum, weights, weight;
    for (const Tap& tap : taps) {
        matchSurfaces(guides, p, tap, weight);
        const float* variance = from.variance.data() + p + tap.offset;
        for (int i = 0; i < kLanes; ++i) {
            sum.value[i] += weight.value[i] * variance[i];
            weights.value[i] += weight.value[i];
        }
    }
    for (int i = 0; i < kLanes; ++i)
        to.variance[static_cast<std::size_t>(p + i)] =
            weights.value[i] > 0 ? sum.value[i] / weights.value[i] : 0;
}

/// The mean residual of the neighbours on the same surface that differ by no more than the noise,
/// and its variance.
void smoothResiduals(const FilterGuides& guides, const Values& from, const Rgb& luminance,
                     std::span<const Tap> taps, float correlation, std::ptrdiff_t p, Values& to) {
    Lanes sum[3], independent, dependent, weights, weight;
    const float* v = from.variance.data();
    const float *r = from.residual[0].data(), *g = from.residual[1].data(),
                *b = from.residual[2].data();
    for (const Tap& tap : taps) {
        const std::ptrdiff_t q = p + tap.offset;
        matchSurfaces(guides, p, tap, weight);
        for (int i = 0; i < kLanes; ++i) {
            const float difference = luminance[0] * (r[q + i] - r[p + i]) +
                                     luminance[1] * (g[q + i] - g[p + i]) +
                                     luminance[2] * (b[q + i] - b[p + i]);
            const float noise =
                kResidualDeviations * kResidualDeviations * (v[p + i] + v[q + i]) + kNoVariance;
            const float w = weight.value[i] * noise / (noise + difference * difference);
            sum[0].value[i] += w * r[q + i];
            sum[1].value[i] += w * g[q + i];
            sum[2].value[i] += w * b[q + i];
            independent.value[i] += w * w * v[q + i];
            dependent.value[i] += w * v[q + i];
            weights.value[i] += w;
        }
    }
    for (int i = 0; i < kLanes; ++i) {
        const float scale = weights.value[i] > 0 ? 1 / weights.value[i] : 0;
        const auto at = static_cast<std::size_t>(p + i);
        for (std::size_t k = 0; k < 3; ++k) to.residual[k][at] = sum[k].value[i] * scale;
        to.variance[at] = scale * ((1 - correlation) * scale * independent.value[i] +
                                   correlation * dependent.value[i]);
    }
}

/// Calls `smooth` for the first of each kLanes pixels, in parallel.
template <class Smooth>
void forEachBlock(const Layout& layout, const Smooth& smooth) {
    parallelFor(static_cast<std::size_t>(layout.rows()), kRowsOfChunk, [&](const Chunk& chunk) {
        for (std::size_t row = chunk.begin; row < chunk.end; ++row)
            for (int block = 0; block < layout.blocks(); ++block)
                smooth(layout.indexOf(block * kLanes, static_cast<int>(row)));
    });
}

}  // namespace

void filterResiduals(ResidualImage& image, const Rgb& luminanceWeights) {
    const Layout layout(image.width, image.height);
    FilterGuides guides(layout.size());
    Values values(layout.size()), smoothed(layout.size());
    const auto forEachPixel = [&](const auto& visit) {
        parallelFor(static_cast<std::size_t>(image.height), kRowsOfChunk, [&](const Chunk& chunk) {
            std::size_t i = chunk.begin * static_cast<std::size_t>(image.width);
            for (std::size_t y = chunk.begin; y < chunk.end; ++y)
                for (int x = 0; x < image.width; ++x)
                    visit(image.pixels[i++],
                          static_cast<std::size_t>(layout.indexOf(x, static_cast<int>(y))));
        });
    };
    forEachPixel([&](const ResidualPixel& pixel, std::size_t at) {
        if (!(pixel.width > 0)) return;
        for (std::size_t k = 0; k < 3; ++k) {
            const int axis = static_cast<int>(k);
            values.residual[k][at] = pixel.residual[axis];
            guides.normal[k][at] = pixel.normal[axis];
            guides.position[k][at] = pixel.position[axis];
        }
        values.variance[at] = pixel.variance;
        guides.height[at] = kMostHeight * pixel.width;
    });
    for (int pass = 0; pass < kVariancePasses; ++pass) {
        const auto taps = tapsOf(layout, 1 << pass);
        forEachBlock(layout,
                     [&](std::ptrdiff_t p) { smoothVariances(guides, values, taps, p, smoothed); });
        values.variance.swap(smoothed.variance);
    }
    for (int pass = 0; pass < kPasses; ++pass) {
        const auto taps = tapsOf(layout, 1 << pass);
        forEachBlock(layout, [&](std::ptrdiff_t p) {
            smoothResiduals(guides, values, luminanceWeights, taps,
                            kCorrelation[static_cast<std::size_t>(pass)], p, smoothed);
        });
        std::swap(values, smoothed);
    }
    forEachPixel([&](ResidualPixel& pixel, std::size_t at) {
        if (!(pixel.width > 0)) return;
        for (std::size_t k = 0; k < 3; ++k)
            pixel.residual[static_cast<int>(k)] = values.residual[k][at];
        pixel.variance = values.variance[at];
    });
}

}  // namespace shadowcache
