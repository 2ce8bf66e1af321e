#include "render/frame/visible_emitters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/estimators/emitter_light.h"
#include "render/estimators/set_place.h"
#include "render/frame/shading.h"

namespace shadowcache {

namespace {

/// Points of a triangle for each pixel of its length, and of its area.
constexpr double kPointsOfPixel = 2;

/// A triangle that emits and is seen, on the film.
struct FilmTriangle {
    const EmitterPart& part;
    double area;    ///< [pixels]
    double length;  ///< of its longest side [pixels]

    bool isThin() const { return 2 * area < length; }
    double wantedPoints() const { return kPointsOfPixel * (length + area); }
};

std::optional<FilmTriangle> onFilm(const EmitterPart& part, const FilmRays& film,
                                   const RenderOptions& options) {
    std::array<double, 3> x{}, y{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::optional<FilmPosition> at = film.project(part.corner[i]);
        if (!at) return {};
        x[i] = at->x * options.width;
        y[i] = at->y * options.height;
    }
    double length = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = (i + 1) % 3;
        length = std::max(length, std::hypot(x[next] - x[i], y[next] - y[i]));
    }
    const double area = std::abs((x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])) / 2;
    // One that all but touches the lens is met by most rays.
    if (!std::isfinite(length + area)) return {};
    return FilmTriangle{part, area, length};
}

/// Whether a part is a triangle of a lamp that cameras see.
bool isArea(const EmitterPart& part) {
    return part.seenByCamera && part.form == EmitterPart::Form::triangle;
}

/// Radiance that a ray shows of what emits: of surfaces, or of lamps.
Rgb partSeen(const FrameRequest& frame, const FilmRay& ray, const EmitterPart& part) {
    if (!part.isSurface()) return lampsSeen(frame, ray);
    if (!ray.view.hit.found) return {0, 0, 0};
    return surfaceSeen(ray.view.hit, frame.options.plain).emission;
}

/// A point of a triangle, uniform in area.
Vec3f pointOf(const EmitterPart& part, double u, double v) {
    const auto root = static_cast<float>(std::sqrt(u)), side = static_cast<float>(v);
    const auto& [a, b, c] = part.corner;
    return a * (1 - root) + b * (root * (1 - side)) + c * (root * side);
}

}  // namespace

VisibleEmitters::VisibleEmitters(const FrameRequest& frame) {
    const EstimatorContext& context = frame.estimator.context();
    if (!context.emitters) return;
    const RenderOptions& options = frame.options;
    const FilmRays film(frame);
    std::vector<FilmTriangle> triangles;
    double thin = 0, wide = 0;  // points that they want
    for (const EmitterPart& part : context.emitters->emitters().parts()) {
        if (!part.isSurface() && !isArea(part)) continue;
        const auto triangle = onFilm(part, film, options);
        if (!triangle) continue;
        triangles.push_back(*triangle);
        (triangle->isThin() ? thin : wide) += triangle->wantedPoints();
    }
    // Wide ones, which most camera rays meet as well, get what thin ones leave.
    const double most = static_cast<double>(options.width) * options.height;
    const double shareOfThin = std::min(1.0, most / std::max(thin, 1.0));
    const double shareOfWide = std::clamp((most - thin) / std::max(wide, 1.0), 0.0, 1.0);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const FilmTriangle& triangle = triangles[t];
        const std::uint64_t seed = hashWords(options.seed, FrameSalt::visibleEmitter, t);
        // A chance, so that a million specks take no more rays than one surface as large.
        const double expected =
            (triangle.isThin() ? shareOfThin : shareOfWide) * triangle.wantedPoints();
        const auto count = static_cast<std::size_t>(
            expected + toUnit(hashWords(seed, FrameSalt::visibleEmitterCount)));
        std::vector<std::uint32_t> u(count), v(count);
        owenSobol(0, 0, seed, u);
        owenSobol(0, 1, seed, v);
        const double covered = triangle.area / expected;
        for (std::size_t k = 0; k < count; ++k) {
            const Vec3f point = pointOf(triangle.part, static_cast<double>(toUnitFloat(u[k])),
                                        static_cast<double>(toUnitFloat(v[k])));
            const std::optional<FilmPosition> at = film.project(point);
            if (!at || at->x < 0 || at->x >= 1 || at->y < 0 || at->y >= 1) continue;
            ++rays_;
            const auto luminance = static_cast<double>(
                context.environment.luminance(partSeen(frame, film.look(*at), triangle.part)));
            Seen& seen = seen_[{static_cast<int>(at->x * options.width),
                                static_cast<int>(at->y * options.height)}];
            seen.luminance += covered * luminance;
            seen.square += covered * luminance * luminance;
        }
    }
}

void VisibleEmitters::addTo(const FilmPlace& pixel, PredictedSpread& spread) const {
    const auto found = seen_.find({pixel.x, pixel.y});
    if (found == seen_.end()) return;
    PredictedSpread with = spread;
    for (Moments* sums : {&with.all, &with.emitted})
        sums->add({found->second.luminance, found->second.square}, spread.count);
    // What the pixel's own rays met as well would count twice, and make an emitter that fills the
    // pixel look even.
    if (with.variances(0).emitted > spread.variances(0).emitted) spread = with;
}

}  // namespace shadowcache
