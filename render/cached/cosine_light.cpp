#include "render/cached/cosine_light.h"

#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/cached/drawn_sample.h"

namespace shadowcache {

CosineLight::Model CosineLight::modelOf(const PointCluster& cluster) {
    const PointBatch& batch = batch_.points;
    const SetPlace& centre = batch.points[cluster.centre].place;
    if (batch_.lookup.pool(batch_.context.scene, centre, cluster.radius) == 0)
        batch_.workspace.pointsWithoutItems += cluster.members.size();
    double samples = 0;
    for (const std::uint32_t member : cluster.members)
        samples += static_cast<double>(batch.points[member].slot.sampleFraction) * batch.samples;
    return {tools_.builder.build(
        CosineIntegrand(batch_.context.environment, splitter_, centre.normal, cluster.tilt,
                        static_cast<float>(batch_.plan.splitNoise / samples)),
        batch_.lookup.pooled(), batch_.plan.calibration)};
}

ClusterCounts CosineLight::countSamples(const PointCluster& cluster, const Model& model) {
    const PointBatch& batch = batch_.points;
    const CachePlan& plan = batch_.plan;
    tools_.wanted.clear();
    heavyFrom_.clear();
    double samples = 0, rays = 0;
    for (const std::uint32_t member : cluster.members) {
        const BatchSlot& slot = batch.points[member].slot;
        const PredictedNoise noise = plan.noiseOf(model.fitted.regions, slot);
        const auto part = static_cast<double>(slot.sampleFraction);
        tools_.wanted.push_back(part * plan.samplesOf(noise, batch.samples));
        heavyFrom_.push_back(plan.heavy * noise.scale * kJudgedSamples / (batch.samples * part));
        samples += tools_.wanted.back();
        rays += part;
    }
    const BatchSlot& first = batch.points[cluster.members.front()].slot;
    const double offset = toUnit(hashWords(first.seed, RenderSalt::shareRounding, first.cameraRay));
    const double mean = samples / rays;  // of the camera rays that were asked for
    return {.ofRegions = roundCounts(tools_.wanted, offset, tools_.counts),
            .judged = kJudgedSamples * mean / batch.samples,
            .heavyFrom = heavyFrom_};
}

const RegionShares& CosineLight::shareSamples(const Regions& regions, const ClusterCounts& counts) {
    return tools_.sharer.share(regions, counts.judged, batch_.plan.brightness(), batch_.plan.heavy);
}

void CosineLight::integrate(const SampledCluster<CosineLight>& cluster,
                            std::span<Estimate> estimates) const {
    const CosineIntegral integral(batch_.context.environment, cluster.model.fitted, cluster.shares);
    for (const std::uint32_t point : cluster.members)
        estimates[point].irradiance = integral.at(batch_.points.points[point].place.normal);
}

void CosineLight::trace(const SampledCluster<CosineLight>& cluster,
                        std::span<const ClusterSample> samples, SampleTracer::Run& run) const {
    for (const ClusterSample& sample : samples) {
        const std::uint32_t number = cluster.members[sample.member];
        const ShadingPoint& point = batch_.points.points[number];
        const RegionPlace& region = sample.place;
        const EnvironmentSample s = sample.finish(batch_.context.environment);
        batch_.workspace.watch(point.slot, s.direction);
        const float x = s.direction.dot(point.place.normal);
        const float c = cluster.shares.groups[region.group].visibility[region.lane];
        traceSample<CosineIntegrand>(
            cluster.shares,
            {number, region, s, static_cast<double>(s.density) * cluster.distribution.light(region),
             sample.inverseCount / s.density},
            x > 0, x, c * cluster.model.fitted.fits[region.group].value(region.lane, x), run);
    }
}

}  // namespace shadowcache
