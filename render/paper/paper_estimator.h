#pragma once

#include <optional>
#include <vector>

#include "common/predict/cached_visibility.h"
#include "common/random/sequence.h"
#include "render/paper/convolution.h"
#include "render/paper/paper_estimators.h"

namespace shadowcache {

/// A triangle of the tessellated hemisphere, or a part of one.
struct PaperPiece {
    SphericalTriangle corners;
    double area;
    double weight;           ///< W
    std::uint32_t triangle;  ///< of the map
};

struct PaperWorkspace : Workspace {
    std::optional<ShadowCache::Reader> reader;
    std::optional<PooledVisibility> pooled;
    std::vector<ItemView> items;
    std::vector<float> convolution;
    std::vector<PaperPiece> pieces;
    std::vector<double> cdf;
    std::vector<double> density;            ///< W / area above the horizon, by triangle
    std::vector<std::uint32_t> triangleOf;  ///< by sample
};

/// The estimator of the paper: importance constant over the triangles of an adaptive triangulation
/// of the map, tabulated diffuse convolutions, clipping to the hemisphere, cached visibility, and
/// perhaps a share of uniform samples. [paper 4, 6.1]
class Paper : public PointEstimator {
public:
    /// @param tables  of the convolutions; false: convolveAll() does without
    Paper(const EstimatorContext& context, const PaperOptions& options, bool tables = true);

    std::unique_ptr<Workspace> makeWorkspace() const override;

protected:
    Rgb prepare(const ShadingPoint& point, const SampleSlice& slice,
                Workspace& workspace) const override;

    const std::vector<MapTriangle>& triangles() const { return triangles_; }

    /// Reads the predictions of the cache around `point` into the workspace.
    virtual void lookUp(const ShadingPoint& point, PaperWorkspace& w) const;
    /// Predicted visibility of a triangle; all is visible where nothing was counted.
    virtual CachedVisibility cached(const PaperWorkspace& w, std::uint32_t triangle) const;
    /// Luminance of the irradiance from each triangle at normal `n`.
    virtual void convolveAll(const Vec3f& n, std::vector<float>& out) const;
    /// Direction in a piece for (u, v) in [0, 1)^2.
    virtual Vec3d sampleIn(const PaperPiece& piece, const Vec3d& n, double u, double v) const;
    /// Density of a direction in a triangle at normal `n`, times the sum of all weights.
    virtual double density(const PaperWorkspace& w, const Vec3d& n, std::uint32_t triangle,
                           const Vec3f& direction) const;

private:
    const PaperOptions options_;
    std::vector<MapTriangle> triangles_;
    std::optional<ConvolutionTable> table_;

    void buildImportance(const ShadingPoint& point, PaperWorkspace& w) const;
    void addTriangle(std::uint32_t triangle, const Vec3d& n, PaperWorkspace& w) const;
    double visibility(const PaperWorkspace& w, std::uint32_t triangle) const;
    Vec3f drawDirection(const PaperWorkspace& w, const Vec3d& n, double x, float v,
                        std::uint32_t& triangle) const;
    std::uint32_t triangleAlong(const Vec3f& direction) const;
};

}  // namespace shadowcache
