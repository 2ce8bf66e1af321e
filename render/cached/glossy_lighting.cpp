#include "render/cached/glossy_lighting.h"

#include "common/base/tuned.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

/// Width of a lobe that the regions resolve about as well as its own samples: half of what is then
/// drawn from the lobe would be drawn from a much narrower one.
SHADOWCACHE_TUNED(double, kResolvedAlpha, 0.04);

}  // namespace

double lobeShare(const GlossyLobe& lobe) {
    const double width = static_cast<double>(lobe.alpha()) / kResolvedAlpha;
    return 0.5 / (1 + width * width);
}

struct GlossyLighting::Task {
    const EstimatorContext& context;
    const GlossyTables& tables;
    const PointBatch& batch;
    std::span<const GlossyPoint> points;
    const GlossyCluster& cluster;
    SampleTracer::Run& run;
};

void GlossyLighting::trace(const EstimatorContext& context, const GlossyTables& tables,
                           const PointBatch& batch, std::span<const GlossyPoint> points,
                           const GlossyCluster& cluster, std::span<const ClusterSample> samples,
                           SampleTracer::Run& run) {
    memberOf_.resize(std::max(memberOf_.size(), points.size()));
    for (std::uint32_t k = 0; k < cluster.members.size(); ++k) memberOf_[cluster.members[k]] = k;
    const Task task{context, tables, batch, points, cluster, run};
    traceRegions(task, samples);
    traceLobes(task);
    run.finish();
}

void GlossyLighting::traceRegions(const Task& task, std::span<const ClusterSample> samples) {
    const Environment& environment = task.context.environment;
    for (const ClusterSample& sample : samples) {
        const RegionGroup& group = task.cluster.fitted.regions.groups[sample.place.group];
        const std::uint32_t cell = group.firstCell + static_cast<std::uint32_t>(sample.place.lane);
        const EnvironmentSample s = sample.finish(environment);
        const double lightDensity =
            static_cast<double>(s.density) * environment.luminanceIntegral(group.level, cell);
        add(task, {memberOf_[sample.point], sample.place, s, lightDensity});
    }
}

/// All points draw from one sequence, one after the other.
void GlossyLighting::traceLobes(const Task& task) {
    std::size_t total = 0;
    for (const PointShare& share : task.cluster.ofLobes)
        total += static_cast<std::size_t>(share.count);
    if (total == 0) return;
    u_.resize(total);
    v_.resize(total);
    const ShadingPoint& first = task.batch.points[task.cluster.members.front()];
    const std::uint64_t seed = hashWords(first.seed, RenderSalt::glossLobes, first.cameraRay);
    fillSequence(task.context.sequence, 0, seed, 0, static_cast<std::uint32_t>(total), u_);
    fillSequence(task.context.sequence, 1, seed, 0, static_cast<std::uint32_t>(total), v_);
    const Environment& environment = task.context.environment;
    std::size_t number = 0;
    for (std::uint32_t k = 0; k < task.cluster.members.size(); ++k) {
        const GlossyLobe& lobe = task.points[task.cluster.members[k]].lobe;
        for (int j = 0; j < task.cluster.ofLobes[k].count; ++j, ++number) {
            EnvironmentSample s =
                environment.lookUp(lobe.sample(toUnitFloat(u_[number]), toUnitFloat(v_[number])));
            s.cell = task.tables.texels.cell(s.texel);
            add(task, {k, task.cluster.distribution.find(s.cell), s,
                       static_cast<double>(s.density) * environment.luminanceIntegral()});
        }
    }
}

void GlossyLighting::add(const Task& task, const Sample& sample) const {
    const GlossyCluster& cluster = task.cluster;
    const std::uint32_t point = cluster.members[sample.member];
    const GlossyLobe& lobe = task.points[point].lobe;
    const EnvironmentSample& s = sample.light;
    const double density =
        cluster.ofLobes[sample.member].divisor * static_cast<double>(lobe.density(s.direction)) +
        cluster.ofRegions[sample.member].divisor *
            cluster.distribution.pdf(sample.place, sample.lightDensity);
    Rgb predicted(0.0f);
    float reuse = 0;
    if (sample.place.found()) {
        const std::uint32_t g = sample.place.group;
        const int i = sample.place.lane;
        const PlannedGroup& planned = cluster.plan.groups[g];
        const RegionGroup& group = cluster.fitted.regions.groups[g];
        const std::uint32_t cell = group.firstCell + static_cast<std::uint32_t>(i);
        if (planned.visibility[i] > 0)
            predicted =
                task.tables.cells.value(cluster.fitted.fits[g], group.level, cell, s.direction) *
                cluster.matches[sample.member].factor * planned.visibility[i];
        reuse = planned.reuse[i];
    }
    if (!(density > 0)) return task.run.add(point, Rgb(0.0f));
    const Rgb light = s.radiance * static_cast<float>(1 / density);
    const Rgb occluded = light * predicted * -1.0f;
    if (!(s.direction.dot(lobe.normal()) > 0)) return task.run.add(point, occluded);
    const Rgb visible = light * lobe.value(s.direction) + occluded;
    if (reuse == 0) return task.run.trace(point, s.direction, visible, occluded);
    // Where the sky is predicted, c is 1: the fit's error counts whatever the ray finds, and an
    // occluder takes away what the lobe reflects.
    if (reuse < 0) task.run.add(point, visible);
    task.run.traceForReuse({s.direction, s.radiance, s.cell, sample.lightDensity, point},
                           reuse > 0);
}

}  // namespace shadowcache
