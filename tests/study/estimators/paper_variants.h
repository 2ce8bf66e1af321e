#pragma once

#include "render/paper/paper_estimator.h"
#include "tests/study/estimators/linear_triangle.h"
#include "tests/study/estimators/makers.h"

namespace shadowcache::study {

/// `paper` with importance linear over a triangle in place of constant, or with convolutions at the
/// normal itself in place of tables.
class PaperVariant : public Paper {
public:
    PaperVariant(const EstimatorContext& context, const VariantOptions& options);

protected:
    void convolveAll(const Vec3f& n, std::vector<float>& out) const override;
    Vec3d sampleIn(const PaperPiece& piece, const Vec3d& n, double u, double v) const override;
    double density(const PaperWorkspace& w, const Vec3d& n, std::uint32_t triangle,
                   const Vec3f& direction) const override;

private:
    const bool exact_;
    std::vector<std::array<double, 3>> shapes_;  ///< linearShape() of each triangle; none: constant

    bool isLinear(std::uint32_t triangle, const Vec3d& n) const;
    LinearTriangle linear(std::uint32_t triangle, const Vec3d& n) const;
};

}  // namespace shadowcache::study
