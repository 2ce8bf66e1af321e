#include "render/bounces/vertex_light.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"
#include "render/estimators/emitter_light.h"
#include "render/estimators/group_split.h"

namespace shadowcache {

namespace {

/// Vertices that are lit together.
SHADOWCACHE_TUNED(std::size_t, kBatchVertices, 4096);

/// One batch of vertices that are lit together.
class LitBatch {
public:
    LitBatch(const Estimator& estimator, const EstimatorPlan* plan, PathLevel& level)
        : estimator_(estimator), plan_(plan), level_(level) {}

    void add(std::uint32_t number) {
        numbers_.push_back(number);
        points_.push_back(shadingPointOf(estimator_.context(), level_.at.vertices[number]));
        points_.back().slot.pixel = static_cast<std::uint32_t>(points_.size() - 1);
    }

    /// @return shadow rays
    std::uint64_t light(Workspace& workspace) {
        const PointBatch batch{
            .points = points_, .pixels = static_cast<std::uint32_t>(points_.size()), .plan = plan_};
        std::vector<Estimate> estimates(points_.size());
        estimator_.estimate(batch, workspace, estimates);
        const GroupedLight grouped =
            splitLight<Estimate>(estimator_.context(), estimates, &Estimate::irradiance, workspace);
        std::uint64_t rays = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            level_.light[numbers_[i]].irradiance += estimates[i].irradiance;
            if (!grouped.empty())
                addTo(level_.groupedLight.irradiance[numbers_[i]], grouped[i], Rgb(1, 1, 1));
            rays += estimates[i].rays + estimates[i].reused;
        }
        return rays + lightLobes(batch, workspace);
    }

private:
    std::uint64_t lightLobes(const PointBatch& batch, Workspace& workspace) {
        GlossyVertices whole, withoutSky;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const PathVertex& v = level_.at.vertices[numbers_[i]];
            if (!v.isGlossy()) continue;
            GlossyVertices& some = v.sharesMirroredSky ? withoutSky : whole;
            some.points.push_back({points_[i], level_.at.lobeOf(v)});
            some.numbers.push_back(numbers_[i]);
        }
        const EstimatorContext& context = estimator_.context();
        std::uint64_t rays = 0;
        if (!whole.points.empty()) {
            std::vector<GlossEstimate> estimates(whole.points.size());
            estimator_.estimateGloss(batch, whole.points, workspace, estimates);
            rays += addMirrored(
                whole, estimates,
                splitLight<GlossEstimate>(context, estimates, &GlossEstimate::radiance, workspace));
        }
        if (!withoutSky.points.empty() && context.emitters) {
            std::vector<GlossEstimate> estimates(withoutSky.points.size());
            GroupedLight grouped;
            if (context.groups) grouped.assign(estimates.size(), context.groups->size());
            EmitterLight::Tools tools(*context.emitters);
            context.emitters->addGloss(
                batch, withoutSky.points, context.environment.luminanceWeights(), tools, estimates,
                context.groups ? GroupSink{context.groups, &grouped} : GroupSink{});
            rays += addMirrored(withoutSky, estimates, grouped);
        }
        return rays;
    }

    /// Glossy ones of the batch's vertices.
    struct GlossyVertices {
        std::vector<GlossyPoint> points;
        std::vector<std::uint32_t> numbers;  ///< in the level
    };

    std::uint64_t addMirrored(const GlossyVertices& glossy,
                              std::span<const GlossEstimate> estimates,
                              const GroupedLight& grouped) {
        std::uint64_t rays = 0;
        for (std::size_t i = 0; i < estimates.size(); ++i) {
            level_.light[glossy.numbers[i]].mirrored += estimates[i].radiance;
            if (!grouped.empty())
                addTo(level_.groupedLight.mirrored[glossy.numbers[i]], grouped[i], Rgb(1, 1, 1));
            rays += estimates[i].rays;
        }
        return rays;
    }

    const Estimator& estimator_;
    const EstimatorPlan* plan_;
    PathLevel& level_;
    std::vector<std::uint32_t> numbers_;
    std::vector<ShadingPoint> points_;
};

}  // namespace

ShadingPoint shadingPointOf(const EstimatorContext& context, const PathVertex& v) {
    const SetPlace place{v.origin, context.scene.mesh().origin + Vec3d(v.target), v.normal,
                         v.geometricNormal};
    BatchSlot slot{.seed = hashWords(v.seed, RenderSalt::bounceDirect)};
    const float counts = context.environment.luminance(v.albedo) * v.weight;
    slot.importance = counts;
    slot.item = v.item;
    if (v.errorScale > 0)
        slot.errorScale = std::min(static_cast<float>(kPi) * v.errorScale / std::max(counts, 1e-6f),
                                   std::numeric_limits<float>::max());
    return {place, slot};
}

std::uint64_t lightVertices(const Estimator& estimator, const EstimatorPlan* plan,
                            Pool<Workspace>& workspaces, PathLevel& level) {
    std::vector<std::uint32_t> lit;
    for (const std::uint32_t i : level.groups.order)
        if (level.choices[i].isLit) lit.push_back(i);
    std::vector<std::uint64_t> rays((lit.size() + kBatchVertices - 1) / kBatchVertices);
    parallelFor(lit.size(), kBatchVertices, [&](const Chunk& chunk) {
        std::unique_ptr<Workspace> workspace =
            workspaces.take([&] { return estimator.makeWorkspace(); });
        LitBatch batch(estimator, plan, level);
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) batch.add(lit[i]);
        rays[chunk.index] = batch.light(*workspace);
        workspaces.giveBack(std::move(workspace));
    });
    return std::accumulate(rays.begin(), rays.end(), std::uint64_t{0});
}

}  // namespace shadowcache
