// Estimators that leave visibility out, or make one number of it: the preconvolved map and ambient
// occlusion. Biased. [paper 3.1]

#include "common/predict/cached_visibility.h"
#include "render/estimators/hemisphere.h"
#include "render/paper/convolution.h"
#include "render/paper/spherical_polygon.h"
#include "tests/study/estimators/makers.h"

namespace shadowcache::study {

namespace {

class Preconvolved final : public PointEstimator {
public:
    explicit Preconvolved(const EstimatorContext& context)
        : PointEstimator(context), map_(context.environment) {}

private:
    IrradianceTable map_;

    Rgb prepare(const ShadingPoint& point, const SampleSlice&, Workspace&) const override {
        return map_.evaluate(point.place.normal);
    }
};

class AmbientOcclusion final : public PointEstimator {
public:
    explicit AmbientOcclusion(const EstimatorContext& context)
        : PointEstimator(context), map_(context.environment) {}

private:
    IrradianceTable map_;

    Rgb prepare(const ShadingPoint& point, const SampleSlice& slice, Workspace& w) const override {
        const Rgb share = map_.evaluate(point.place.normal) / static_cast<float>(slice.count);
        const auto u = w.numbers(context_.sequence, point.slot.seed, 0, slice.first, slice.count);
        const auto v = w.numbers(context_.sequence, point.slot.seed, 1, slice.first, slice.count);
        for (std::size_t i = 0; i < u.size(); ++i)
            w.samples.add(aroundNormal(point.place.normal, toUnitFloat(u[i]), toUnitFloat(v[i])),
                          share);
        w.samples.endGroup();
        return {0, 0, 0};
    }
};

struct OcclusionWorkspace final : Workspace {
    explicit OcclusionWorkspace(const ShadowCache& cache)
        : reader(cache), pooled(cache.header().tiers()), items(ShadowCache::kMaxItems) {}

    ShadowCache::Reader reader;
    PooledVisibility pooled;
    std::vector<ItemView> items;
};

class AmbientOcclusionCached final : public PointEstimator {
public:
    explicit AmbientOcclusionCached(const EstimatorContext& context)
        : PointEstimator(context), map_(context.environment) {
        for (std::uint32_t c = 0; c < cellCount(kLevel); ++c) {
            cells_.push_back(cellTriangle(kLevel, c));
            areas_.push_back(solidAngle(cells_.back()));
        }
    }

    std::unique_ptr<Workspace> makeWorkspace() const override {
        return std::make_unique<OcclusionWorkspace>(*context_.cache);
    }

private:
    static constexpr int kLevel = 3;
    IrradianceTable map_;
    std::vector<SphericalTriangle> cells_;
    std::vector<double> areas_;

    Rgb prepare(const ShadingPoint& point, const SampleSlice&,
                Workspace& workspace) const override {
        auto& w = static_cast<OcclusionWorkspace&>(workspace);
        const int found =
            w.reader.lookUp(point.place.position, point.place.geometricNormal, w.items);
        w.pooled.pool(std::span(w.items).first(static_cast<std::size_t>(found)));
        const Vec3d n(point.place.normal);
        double visible = 0, all = 0;
        for (std::uint32_t c = 0; c < cells_.size(); ++c) {
            const double area = areaAbove(c, n);
            if (!(area > 0)) continue;
            const CachedVisibility v = visibilityOf(w.pooled, kLevel, c);
            visible += area * static_cast<double>(v.ratio);
            all += area;
        }
        return map_.evaluate(point.place.normal) * static_cast<float>(visible / all);
    }

    double areaAbove(std::uint32_t cell, const Vec3d& n) const {
        const SphericalTriangle& t = cells_[cell];
        const bool above[] = {n.dot(t.a) > 0, n.dot(t.b) > 0, n.dot(t.c) > 0};
        if (above[0] && above[1] && above[2]) return areas_[cell];
        if (!above[0] && !above[1] && !above[2]) return 0;
        const ClippedTriangle clipped = clipToHemisphere(t, n);
        double area = 0;
        for (int k = 0; k < clipped.count; ++k)
            area += solidAngle(clipped.pieces[static_cast<std::size_t>(k)]);
        return area;
    }
};

}  // namespace

std::unique_ptr<Estimator> makePreconvolved(const EstimatorContext& context) {
    return std::make_unique<Preconvolved>(context);
}
std::unique_ptr<Estimator> makeAmbientOcclusion(const EstimatorContext& context) {
    return std::make_unique<AmbientOcclusion>(context);
}
std::unique_ptr<Estimator> makeAmbientOcclusionCached(const EstimatorContext& context) {
    return std::make_unique<AmbientOcclusionCached>(context);
}

}  // namespace shadowcache::study
