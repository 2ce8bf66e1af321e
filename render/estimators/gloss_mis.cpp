// What glossy surfaces reflect, without a cache: samples of the map and of the lobe. Multiple
// importance sampling of the two is queueGloss() in gloss_mis.h.

#include "render/estimators/gloss_mis.h"

#include "common/base/stopwatch.h"

namespace shadowcache {

GlossEstimate traceGloss(const EstimatorContext& context, const SetPlace& place, Workspace& w) {
    Estimate sum;
    w.samples.trace(context.scene, place, context.environment, sum);
    return {sum.irradiance, sum.variance, sum.rays};
}

void Estimator::estimateGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                              Workspace& workspace, std::span<GlossEstimate> estimates) const {
    Stopwatch watch;
    const bool dark = context_.environment.luminanceIntegral() <= 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        estimates[i] = {};
        if (dark || batch.samples == 0) continue;
        workspace.samples.clear();
        queueGloss(context_, points[i], sliceOf(batch, points[i].point.slot),
                   WholeMap{context_.environment}, workspace);
        workspace.setupNanoseconds += watch.sinceLast();
        estimates[i] = traceGloss(context_, points[i].point.place, workspace);
        workspace.traceNanoseconds += watch.sinceLast();
    }
}

}  // namespace shadowcache
