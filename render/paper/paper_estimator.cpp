#include "render/paper/paper_estimator.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.h"
#include "common/base/option_checks.h"
#include "render/estimators/full_precision.h"
#include "render/estimators/hemisphere.h"
#include "render/paper/spherical_polygon.h"

namespace shadowcache {

namespace {

constexpr double kBelowOne = 0x1.fffffffffffffp-1;

/// Least cosine, at a triangle's middle, that its least light is multiplied with.
constexpr double kLeastFloorCosine = 0.05;

void addPiece(const PaperPiece& piece, PaperWorkspace& w) {
    if (!(piece.weight > 0) || !(piece.area > 0)) return;
    w.pieces.push_back(piece);
    w.cdf.push_back((w.cdf.empty() ? 0.0 : w.cdf.back()) + piece.weight);
}

/// First cell of the finest level in a triangle: the triangles stand in the order of these.
std::uint64_t firstCell(const MapTriangle& t) {
    return std::uint64_t{t.cell} << (2 * (kMaxDirectionLevel - t.level));
}

}  // namespace

Paper::Paper(const EstimatorContext& context, const PaperOptions& options, bool tables)
    : PointEstimator(context),
      options_(options),
      triangles_(triangulateMap(context.environment, options.triangles, options.minLevel,
                                options.maxLevel)) {
    if (tables) table_.emplace(context.environment, triangles_);
}

std::unique_ptr<Workspace> Paper::makeWorkspace() const {
    auto w = std::make_unique<PaperWorkspace>();
    if (context_.cache) {
        w->reader.emplace(*context_.cache);
        w->pooled.emplace(context_.cache->header().tiers());
        w->items.resize(ShadowCache::kMaxItems);
    }
    return w;
}

void Paper::lookUp(const ShadingPoint& point, PaperWorkspace& w) const {
    if (!w.reader) return;
    const int found = w.reader->lookUp(point.place.position, point.place.geometricNormal, w.items);
    w.pooled->pool(std::span(w.items).first(static_cast<std::size_t>(found)));
}

CachedVisibility Paper::cached(const PaperWorkspace& w, std::uint32_t triangle) const {
    if (!w.pooled) return {};
    const MapTriangle& t = triangles_[triangle];
    const int level = std::min(t.level, options_.cacheLevel);
    return visibilityOf(*w.pooled, level, ancestorCell(t.cell, t.level, level));
}

Rgb Paper::prepare(const ShadingPoint& point, const SampleSlice& slice,
                   Workspace& workspace) const {
    auto& w = static_cast<PaperWorkspace&>(workspace);
    buildImportance(point, w);
    w.triangleOf.clear();
    const double total = w.cdf.empty() ? 0.0 : w.cdf.back();
    if (!(total > 0)) return {0, 0, 0};
    const double beta = options_.beta;
    const Vec3d n(point.place.normal);
    const auto u = w.numbers(context_.sequence, point.slot.seed, 0, slice.first, slice.count);
    const auto v = w.numbers(context_.sequence, point.slot.seed, 1, slice.first, slice.count);
    for (std::size_t j = 0; j < u.size(); ++j) {
        const double x = fullPrecision(u[j], point.slot.seed, slice.first + j);
        Vec3f direction;
        std::uint32_t triangle = 0;
        if (x < beta) {
            direction =
                aroundNormal(point.place.normal, static_cast<float>(x / beta), toUnitFloat(v[j]));
            triangle = triangleAlong(direction);
        } else {
            direction =
                drawDirection(w, n, (x - beta) / (1 - beta) * total, toUnitFloat(v[j]), triangle);
        }
        w.triangleOf.push_back(triangle);
        const float cosine = direction.dot(point.place.normal);
        if (cosine <= 0) {
            w.samples.addZero();
            continue;
        }
        const double density =
            beta / (2 * kPi) + (1 - beta) * this->density(w, n, triangle, direction) / total;
        w.samples.add(direction, context_.environment.radiance(direction) *
                                     (cosine / static_cast<float>(density * slice.count)));
    }
    w.samples.endGroup();
    return {0, 0, 0};
}

/// W_i of all triangles, clipped to the hemisphere, and their running sum.
void Paper::buildImportance(const ShadingPoint& point, PaperWorkspace& w) const {
    lookUp(point, w);
    convolveAll(point.place.normal, w.convolution);
    w.pieces.clear();
    w.cdf.clear();
    w.density.assign(triangles_.size(), 0.0);
    for (std::uint32_t i = 0; i < triangles_.size(); ++i)
        addTriangle(i, Vec3d(point.place.normal), w);
}

void Paper::convolveAll(const Vec3f& n, std::vector<float>& out) const {
    table_->evaluate(n, out);
}

void Paper::addTriangle(std::uint32_t triangle, const Vec3d& n, PaperWorkspace& w) const {
    const MapTriangle& t = triangles_[triangle];
    const double height = n.dot(t.axis), sine = t.sinRadius;
    if (height <= -sine || (t.luminanceIntegral <= 0 && t.floor <= 0)) return;
    const double light = std::max(static_cast<double>(w.convolution[triangle]),
                                  t.floor * std::max(height, kLeastFloorCosine));
    const double weight = light * visibility(w, triangle);
    if (height >= sine) {
        w.density[triangle] = weight / t.area;
        addPiece({t.corners, t.area, weight, triangle}, w);
        return;
    }
    const ClippedTriangle clipped = clipToHemisphere(t.corners, n);
    double areas[2] = {0, 0};
    for (int k = 0; k < clipped.count; ++k)
        areas[k] = solidAngle(clipped.pieces[static_cast<std::size_t>(k)]);
    const double area = areas[0] + areas[1];
    if (!(area > 0)) return;
    w.density[triangle] = weight / area;
    for (int k = 0; k < clipped.count; ++k)
        addPiece({clipped.pieces[static_cast<std::size_t>(k)], areas[k], weight * areas[k] / area,
                  triangle},
                 w);
}

/// alpha A + (1 - alpha) / 2. [paper 4.3]
double Paper::visibility(const PaperWorkspace& w, std::uint32_t triangle) const {
    const CachedVisibility v = cached(w, triangle);
    const double a =
        v.rays < static_cast<float>(options_.threshold) ? 1.0 : static_cast<double>(v.ratio);
    return options_.alpha * a + (1 - options_.alpha) * 0.5;
}

/// Place `x` in [0, total) of the running sum -> piece and direction. [paper 4.2: Idx, Coord,
/// SphTri]
Vec3f Paper::drawDirection(const PaperWorkspace& w, const Vec3d& n, double x, float v,
                           std::uint32_t& triangle) const {
    auto i =
        static_cast<std::size_t>(std::upper_bound(w.cdf.begin(), w.cdf.end(), x) - w.cdf.begin());
    i = std::min(i, w.pieces.size() - 1);
    const PaperPiece& piece = w.pieces[i];
    triangle = piece.triangle;
    const double coordinate =
        std::clamp((x - (w.cdf[i] - piece.weight)) / piece.weight, 0.0, kBelowOne);
    return Vec3f(sampleIn(piece, n, coordinate, static_cast<double>(v)));
}

Vec3d Paper::sampleIn(const PaperPiece& piece, const Vec3d&, double u, double v) const {
    return sampleDirection(piece.corners, u, v);
}

double Paper::density(const PaperWorkspace& w, const Vec3d&, std::uint32_t triangle,
                      const Vec3f&) const {
    return w.density[triangle];
}

std::uint32_t Paper::triangleAlong(const Vec3f& direction) const {
    const std::uint64_t cell = locateCell(kMaxDirectionLevel, Vec3d(direction));
    const auto after =
        std::upper_bound(triangles_.begin(), triangles_.end(), cell,
                         [](std::uint64_t c, const MapTriangle& t) { return c < firstCell(t); });
    return static_cast<std::uint32_t>(after - triangles_.begin() - 1);
}

void validate(const PaperOptions& options) {
    requireRange("triangles", options.triangles, 20, 100000);
    requireRange("max-level", options.maxLevel, 0, 7);
    requireRange("min-level", options.minLevel, 0, options.maxLevel);
    requireRange("threshold", options.threshold, 0, 1000);
    requireRange("beta", options.beta, 0.0, 1.0);
    requireRange("cache-level", options.cacheLevel, 0, 7);
    if (!(options.alpha >= 0 && options.alpha < 1)) {
        throw Error(
            fmt::format("--alpha {:g}: expected 0 or more and below 1 (at 1 a cached 0 would never "
                        "be sampled: biased)",
                        options.alpha));
    }
}

std::unique_ptr<Estimator> makePaper(const EstimatorContext& context, const PaperOptions& options) {
    return std::make_unique<Paper>(context, options);
}

}  // namespace shadowcache
