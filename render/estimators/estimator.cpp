#include "render/estimators/estimator.h"

#include <vector>

#include "common/base/stopwatch.h"

namespace shadowcache {

std::unique_ptr<Workspace> Estimator::makeWorkspace() const {
    return std::make_unique<Workspace>();
}

void PointEstimator::estimate(const PointBatch& batch, Workspace& workspace,
                              std::span<Estimate> estimates) const {
    Stopwatch watch;
    for (std::size_t i = 0; i < batch.points.size(); ++i) {
        const ShadingPoint& point = batch.points[i];
        workspace.samples.clear();
        estimates[i] = {};
        estimates[i].irradiance = prepare(point, sliceOf(batch, point.slot), workspace);
        workspace.setupNanoseconds += watch.sinceLast();
        if (workspace.samples.size() == 0) continue;
        for (std::size_t j = 0; workspace.watchedPixel && j < workspace.samples.size(); ++j)
            workspace.watch(point.slot, workspace.samples.direction(j));
        workspace.samples.trace(context_.scene, point.place, context_.environment, estimates[i]);
        workspace.traceNanoseconds += watch.sinceLast();
    }
}

void Estimator::estimate(std::span<const ShadingPoint> points, int samples, Workspace& workspace,
                         std::span<Estimate> estimates, const EstimatorPlan* plan) const {
    std::vector<ShadingPoint> alone(points.begin(), points.end());
    for (std::size_t i = 0; i < alone.size(); ++i) {
        BatchSlot& slot = alone[i].slot;
        slot.pixel = static_cast<std::uint32_t>(i);
        slot.cameraRay = slot.row = 0;
    }
    PointBatch batch{alone, samples, static_cast<std::uint32_t>(alone.size())};
    batch.plan = plan;
    estimate(batch, workspace, estimates);
}

Estimate Estimator::estimate(const ShadingPoint& point, int samples, Workspace& workspace,
                             const EstimatorPlan* plan) const {
    Estimate result;
    estimate({&point, 1}, samples, workspace, {&result, 1}, plan);
    return result;
}

}  // namespace shadowcache
