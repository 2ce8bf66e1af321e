#include "tests/study/estimators/paper_variants.h"

#include <algorithm>

#include "common/base/option_checks.h"

namespace shadowcache::study {

namespace {

/// Least cosine at a corner of a triangle: on the horizon itself the density must not be zero.
constexpr double kLeastCornerCosine = 1e-3;

}  // namespace

PaperVariant::PaperVariant(const EstimatorContext& context, const VariantOptions& options)
    : Paper(context, options, !options.exactConvolution), exact_(options.exactConvolution) {
    if (options.order == 0) return;
    for (const MapTriangle& t : triangles())
        shapes_.push_back(t.luminanceIntegral > 0 ? linearShape(t.corners, t.firstMoment)
                                                  : std::array<double, 3>{1, 1, 1});
}

void PaperVariant::convolveAll(const Vec3f& n, std::vector<float>& out) const {
    if (!exact_) return Paper::convolveAll(n, out);
    out.clear();
    for (const MapTriangle& t : triangles())
        out.push_back(static_cast<float>(convolve(context_.environment, t, Vec3d(n))));
}

/// Whether the importance in a triangle is linear: in one that the horizon may cut it never is.
bool PaperVariant::isLinear(std::uint32_t triangle, const Vec3d& n) const {
    const MapTriangle& t = triangles()[triangle];
    return !shapes_.empty() && n.dot(t.axis) >= t.sinRadius;
}

LinearTriangle PaperVariant::linear(std::uint32_t triangle, const Vec3d& n) const {
    const SphericalTriangle& corners = triangles()[triangle].corners;
    const std::array<double, 3>& shape = shapes_[triangle];
    return {corners,
            {shape[0] * std::max(kLeastCornerCosine, n.dot(corners.a)),
             shape[1] * std::max(kLeastCornerCosine, n.dot(corners.b)),
             shape[2] * std::max(kLeastCornerCosine, n.dot(corners.c))}};
}

Vec3d PaperVariant::sampleIn(const PaperPiece& piece, const Vec3d& n, double u, double v) const {
    if (isLinear(piece.triangle, n)) return linear(piece.triangle, n).sample(u, v);
    return Paper::sampleIn(piece, n, u, v);
}

double PaperVariant::density(const PaperWorkspace& w, const Vec3d& n, std::uint32_t triangle,
                             const Vec3f& direction) const {
    const double constant = Paper::density(w, n, triangle, direction);
    if (!isLinear(triangle, n)) return constant;
    return constant * triangles()[triangle].area * linear(triangle, n).density(Vec3d(direction));
}

void validate(const VariantOptions& options) {
    shadowcache::validate(options);
    requireRange("order", options.order, 0, 1);
}

std::unique_ptr<Estimator> makePaperVariant(const EstimatorContext& context,
                                            const VariantOptions& options) {
    return std::make_unique<PaperVariant>(context, options);
}

}  // namespace shadowcache::study
