#include "render/cached/cluster_lighting.h"

namespace shadowcache {

void ClusterLighting::trace(const EstimatorContext& context, const PointBatch& batch,
                            const Regions& regions, const SamplingPlan& plan,
                            std::span<const ClusterSample> samples, NeighborReuse::Batch& reuse,
                            std::span<Estimate> estimates) {
    const Environment& environment = context.environment;
    partners_.resize(std::max(partners_.size(), batch.points.size()));
    for (const ClusterSample& sample : samples) partners_[sample.point] = {};
    for (const ClusterSample& sample : samples) {
        const ShadingPoint& point = batch.points[sample.point];
        const RegionGroup& region = regions.groups[sample.group];
        const PlannedGroup& planned = plan.groups[sample.group];
        const int i = sample.lane;
        const EnvironmentSample s = sample.finish(environment);
        const float x = s.direction.dot(point.normal);
        const Rgb light = s.radiance * (sample.share / s.density);
        const float predicted =
            planned.visibility[i] *
            (region.constant[i] + x * (region.linear[i] + x * region.square[i]));
        if (x <= 0) {  // no ray: below the point's horizon nothing is seen
            addValue(environment, sample.point, light * -predicted, estimates);
            continue;
        }
        Pending& p = pending_[queued_];
        p.point = sample.point;
        p.reuse = planned.reuse[i];
        if (p.reuse != 0) {
            p.ifVisible = p.ifOccluded = Rgb(0, 0, 0);
            const std::uint32_t cell = region.firstCell + static_cast<std::uint32_t>(i);
            p.found = {
                s.direction, s.radiance, s.cell,
                static_cast<double>(s.density) * environment.luminanceIntegral(region.level, cell),
                sample.point};
        } else {
            p.ifVisible = light * (x - predicted);
            p.ifOccluded = light * -predicted;
        }
        packet_.set(queued_++, point.rayOrigin, s.direction);
        if (queued_ == RayPacket::kSize) flush(context, reuse, estimates);
    }
    if (queued_ > 0) flush(context, reuse, estimates);
    for (const ClusterSample& sample : samples) {
        // Of a single sample only its square is known, next to the variance of a residual.
        Partner& partner = partners_[sample.point];
        if (!partner.waits || partner.paired) continue;
        estimates[sample.point].variance += partner.luminance * partner.luminance;
        partner.waits = false;
    }
}

void ClusterLighting::flush(const EstimatorContext& context, NeighborReuse::Batch& reuse,
                            std::span<Estimate> estimates) {
    const std::uint32_t visible = context.scene.visibility(packet_, queued_);
    for (int k = 0; k < queued_; ++k) {
        const Pending& p = pending_[k];
        const bool isVisible = (visible >> k & 1u) != 0;
        ++estimates[p.point].rays;
        if (p.reuse != 0 && isVisible == (p.reuse > 0)) reuse.add(p.found);
        addValue(context.environment, p.point, isVisible ? p.ifVisible : p.ifOccluded, estimates);
    }
    queued_ = 0;
}

/// The squared difference of two neighbours in the order of regions estimates the variance of their
/// sum.
void ClusterLighting::addValue(const Environment& environment, std::uint32_t point,
                               const Rgb& value, std::span<Estimate> estimates) {
    estimates[point].irradiance += value;
    Partner& partner = partners_[point];
    const float luminance = environment.luminance(value);
    if (partner.waits) {
        const float difference = luminance - partner.luminance;
        estimates[point].variance += difference * difference;
        partner.paired = true;
    }
    partner.luminance = luminance;
    partner.waits = !partner.waits;
}

}  // namespace shadowcache
