#include "render/cached/lobe_light.h"

#include <algorithm>

#include "common/base/tuned.h"
#include "common/random/sequence.h"
#include "render/cached/drawn_sample.h"

namespace shadowcache {

namespace {

/// Samples of the regions in proportion to the light that the central lobe reflects, for each that
/// follows the counts: more than for the irradiance, as the other lobes differ from the central.
SHADOWCACHE_TUNED(double, kGlossyDefensiveShare, 0.8);

/// Part of what a point reflects from which on a sample is reused: less than of the irradiance, as
/// fewer regions make up for one that is mispredicted.
SHADOWCACHE_TUNED(double, kGlossyHeavy, 0.02);

/// Predicted visibility from which on reuse expects the sky: almost surely, as a lobe that is
/// wrongly predicted bright is all that a dark point has.
constexpr float kGlossyMostlyVisible = 0.97f;

/// Least width of a lobe that fits over the finest cells follow; regions are chosen for narrower
/// ones as if they were so wide.
constexpr float kLeastFittedAlpha = 0.03f;

/// Width of a lobe that the regions resolve about as well as its own samples: half of what is then
/// drawn from the lobe would be drawn from a much narrower one.
SHADOWCACHE_TUNED(double, kResolvedAlpha, 0.04);

/// Part of a cluster's samples that are drawn from the lobes: less where regions resolve them.
double partOfLobes(const GlossyLobe& lobe) {
    const double width = static_cast<double>(lobe.alpha()) / kResolvedAlpha;
    return 0.5 / (1 + width * width);
}

}  // namespace

ShareRules lobeRules() {
    return {kGlossyDefensiveShare, 0, kGlossyMostlyVisible};
}

const LobeTables& LazyLobeTables::of(const EstimatorContext& context) const {
    std::call_once(made_,
                   [&] { tables_.emplace(context.environment, context.cache->header().tiers()); });
    return *tables_;
}

const FittedRegions<LobeIntegrand>& LobeLight::build(const GlossyLobe& lobe, float misfit) {
    const EstimatorContext& context = batch_.context;
    return w_.tools.builder.build(
        LobeIntegrand(context.environment, tables_.cells, context.cache->header().tiers(),
                      leastNoise_, lobe, misfit),
        batch_.lookup.pooled(), batch_.plan.calibration);
}

LobeLight::Model LobeLight::match(const PointCluster& cluster, bool fitted) {
    const GlossyLobe& central = points_[cluster.centre].lobe;
    const SetPlace& centre = batch_.points.points[cluster.centre].place;
    batch_.lookup.pool(batch_.context.scene, centre, cluster.radius);
    const LobeMatch match(central);
    float misfit = 0;
    w_.matches.clear();
    for (const std::uint32_t point : cluster.members) {
        w_.matches.push_back(match.fit(points_[point].lobe));
        misfit += w_.matches.back().misfit / static_cast<float>(cluster.members.size());
        if (!fitted) w_.matches.back().factor = Rgb(0.0f);
    }
    return {build(central.widened(kLeastFittedAlpha), fitted ? misfit : 1.0f), w_.matches,
            partOfLobes(central)};
}

LobeLight::Model LobeLight::modelOf(const PointCluster& cluster) {
    return match(cluster, points_[cluster.centre].lobe.alpha() >= kLeastFittedAlpha);
}

std::span<const SampleCount> LobeLight::round(const PointCluster& cluster, double part,
                                              RenderSalt salt, std::vector<SampleCount>& counts) {
    const PointBatch& batch = batch_.points;
    w_.tools.wanted.clear();
    for (const std::uint32_t member : cluster.members)
        w_.tools.wanted.push_back(batch.samples * part *
                                  static_cast<double>(batch.points[member].slot.sampleFraction));
    const BatchSlot& first = batch.points[cluster.members.front()].slot;
    return roundCounts(w_.tools.wanted, toUnit(hashWords(first.seed, salt, first.cameraRay)),
                       counts);
}

ClusterCounts LobeLight::countSamples(const PointCluster& cluster, const Model& model) {
    return {
        .ofRegions = round(cluster, 1 - model.partOfLobes, RenderSalt::glossShare, w_.tools.counts),
        .ofLobes = round(cluster, model.partOfLobes, RenderSalt::glossRounding, w_.lobeCounts)};
}

const RegionShares& LobeLight::shareSamples(const Regions& regions, const ClusterCounts& counts) {
    return w_.tools.sharer.share(regions, counts.judged,
                                 {batch_.plan.darkest / kPi, kUnsureShareUniform}, kGlossyHeavy);
}

void LobeLight::integrate(const SampledCluster<LobeLight>& cluster,
                          std::span<Estimate> estimates) const {
    const Rgb integral = integralOf(tables_.cells, cluster.model.fitted, cluster.shares);
    for (std::size_t k = 0; k < cluster.members.size(); ++k)
        estimates[cluster.members[k]].irradiance = integral * cluster.model.matches[k].factor;
}

void LobeLight::trace(const SampledCluster<LobeLight>& cluster,
                      std::span<const ClusterSample> samples, SampleTracer::Run& run) {
    for (const ClusterSample& sample : samples) {
        const EnvironmentSample s = sample.finish(batch_.context.environment);
        traceOne(cluster, sample.member, sample.place, s,
                 static_cast<double>(s.density) * cluster.distribution.light(sample.place), run);
    }
    traceLobes(cluster, run);
}

/// All points draw from one sequence, one after the other.
void LobeLight::traceLobes(const SampledCluster<LobeLight>& cluster, SampleTracer::Run& run) {
    const EstimatorContext& context = batch_.context;
    const std::span<const std::uint32_t> members = cluster.members;
    const std::span<const SampleCount> counts = cluster.counts.ofLobes;
    std::size_t total = 0;
    for (const SampleCount& count : counts) total += static_cast<std::size_t>(count.drawn);
    if (total == 0) return;
    w_.u.resize(total);
    w_.v.resize(total);
    const BatchSlot& first = batch_.points.points[members.front()].slot;
    const std::uint64_t seed = hashWords(first.seed, RenderSalt::glossLobes, first.cameraRay);
    context.sequence.fill(0, 0, seed, w_.u);
    context.sequence.fill(0, 1, seed, w_.v);
    const Environment& environment = context.environment;
    std::size_t number = 0;
    for (std::uint32_t k = 0; k < members.size(); ++k) {
        const GlossyLobe& lobe = points_[members[k]].lobe;
        for (int j = 0; j < counts[k].drawn; ++j, ++number) {
            const EnvironmentSample s = environment.lookUp(
                lobe.sample(toUnitFloat(w_.u[number]), toUnitFloat(w_.v[number])));
            traceOne(cluster, k, cluster.distribution.find(s.cell), s,
                     static_cast<double>(s.density) * environment.luminanceIntegral(), run);
        }
    }
}

void LobeLight::traceOne(const SampledCluster<LobeLight>& cluster, std::uint32_t member,
                         const RegionPlace& region, const EnvironmentSample& s, double lightDensity,
                         SampleTracer::Run& run) const {
    const std::uint32_t point = cluster.members[member];
    const GlossyLobe& lobe = points_[point].lobe;
    const double density =
        cluster.counts.ofLobes[member].divisor * static_cast<double>(lobe.density(s.direction)) +
        cluster.counts.ofRegions[member].divisor * cluster.distribution.pdf(region, lightDensity);
    if (!(density > 0)) return run.add(point, Rgb(0.0f));
    const float c =
        region.found() ? cluster.shares.groups[region.group].visibility[region.lane] : 0.0f;
    Rgb standIn(0.0f);
    if (c > 0) {
        const FittedRegions<LobeIntegrand>& fitted = cluster.model.fitted;
        const RegionGroup& group = fitted.regions.groups[region.group];
        standIn = tables_.cells.value(fitted.fits[region.group], group.level,
                                      group.firstCell + static_cast<std::uint32_t>(region.lane),
                                      s.direction) *
                  cluster.model.matches[member].factor * c;
    }
    traceSample<LobeIntegrand>(
        cluster.shares, {point, region, s, lightDensity, static_cast<float>(1 / density)},
        s.direction.dot(lobe.normal()) > 0, lobe.value(s.direction), standIn, run);
}

void LobeLight::predict(std::span<Estimate> estimates) {
    const PointBatch& batch = batch_.points;
    for (const PointCluster& cluster : w_.tools.clusters.build(
             batch.points, batch_.context.cache->header().spacing, batch.cameraRays, 0)) {
        const Model model = match(cluster, true);
        const Rgb predicted = predictionOf(tables_.cells, model.fitted);
        for (std::size_t k = 0; k < cluster.members.size(); ++k) {
            const std::uint32_t point = cluster.members[k];
            estimates[point].irradiance = predicted * model.matches[k].factor;
            if (model.matches[k].factor != Rgb(0.0f)) continue;
            const GlossyLobe lobe = points_[point].lobe.widened(kLeastFittedAlpha);
            estimates[point].irradiance = predictionOf(tables_.cells, build(lobe, 0));
        }
    }
}

}  // namespace shadowcache
