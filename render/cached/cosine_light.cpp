#include "render/cached/cosine_light.h"

#include "common/random/salts.h"
#include "common/random/sequence.h"

namespace shadowcache {

const FittedRegions<CosineIntegrand>& CosineLight::regionsOf(
    const PointCluster& cluster, std::span<const std::uint32_t> members) {
    const ShadingPoint& centre = batch_.points[cluster.centre];
    if (lookup_.pool(context_.scene, centre, cluster.radius) == 0)
        watch_.pointsWithoutItems += members.size();
    double samples = 0;
    for (const std::uint32_t member : members)
        samples += static_cast<double>(batch_.points[member].sampleFraction) * batch_.samples;
    return tools_.builder.build(
        CosineIntegrand(context_.environment, splitter_, centre.normal, cluster.tilt,
                        static_cast<float>(frame_.splitNoise / samples)),
        lookup_.pooled(), frame_.calibration);
}

const SamplingPlan& CosineLight::plan(const Regions& regions,
                                      std::span<const std::uint32_t> members) {
    tools_.wanted.clear();
    heavyFrom_.clear();
    double samples = 0, rays = 0;
    for (const std::uint32_t member : members) {
        const ShadingPoint& point = batch_.points[member];
        const PredictedNoise noise = frame_.noiseOf(regions, point);
        const auto part = static_cast<double>(point.sampleFraction);
        tools_.wanted.push_back(part * frame_.samplesOf(noise, batch_.samples));
        heavyFrom_.push_back(frame_.heavy * noise.scale * kJudgedSamples / (batch_.samples * part));
        samples += tools_.wanted.back();
        rays += part;
    }
    const ShadingPoint& first = batch_.points[members.front()];
    roundCounts(tools_.wanted,
                toUnit(hashWords(first.seed, RenderSalt::shareRounding, first.cameraRay)),
                tools_.counts);
    const double mean = samples / rays;  // of the camera rays that were asked for
    return tools_.planner.plan(regions, kJudgedSamples * mean / batch_.samples, frame_.brightness(),
                               frame_.heavy);
}

void CosineLight::addIntegrals(const FittedRegions<CosineIntegrand>& fitted,
                               const SamplingPlan& plan, std::span<const std::uint32_t> members,
                               std::span<Estimate> estimates) const {
    const CosineIntegral integral(context_.environment, fitted, plan);
    for (const std::uint32_t point : members)
        estimates[point].irradiance = integral.at(batch_.points[point].normal);
}

void CosineLight::trace(const PlannedCluster<CosineIntegrand>& cluster,
                        std::span<const ClusterSample> samples, SampleTracer::Run& run) const {
    const Environment& environment = context_.environment;
    for (const ClusterSample& sample : samples) {
        const ShadingPoint& point = batch_.points[sample.point];
        const RegionPlace& place = sample.place;
        const EnvironmentSample s = sample.finish(environment);
        watch_.watch(point, s.direction);
        const float x = s.direction.dot(point.normal);
        const float c = cluster.plan.groups[place.group].visibility[place.lane];
        traceSample<CosineIntegrand>(
            cluster.plan,
            {sample.point, place, s,
             static_cast<double>(s.density) * cluster.distribution.light(place),
             sample.inverseCount / s.density},
            x > 0, x, c * cluster.fitted.fits[place.group].value(place.lane, x), run);
    }
}

}  // namespace shadowcache
