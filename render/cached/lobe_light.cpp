#include "render/cached/lobe_light.h"

#include <algorithm>

#include "common/base/tuned.h"
#include "common/random/sequence.h"

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

PlanRules lobeRules() {
    return {kGlossyDefensiveShare, 0, kGlossyMostlyVisible};
}

const LobeTables& LazyLobeTables::of(const EstimatorContext& context) const {
    std::call_once(made_,
                   [&] { tables_.emplace(context.environment, context.cache->header().tiers()); });
    return *tables_;
}

LobeLight::LobeLight(const EstimatorContext& context, const CachePlan& plan,
                     const PointBatch& batch, std::span<const GlossyPoint> points,
                     const LobeTables& tables, float leastNoise, PlaceLookup& lookup,
                     LobeWorkspace& w)
    : context_(context),
      frame_(plan),
      batch_(batch),
      points_(points),
      tables_(tables),
      leastNoise_(leastNoise),
      lookup_(lookup),
      w_(w) {
    w_.lobeSamples.assign(points.size(), 0);
    w_.memberOf.resize(points.size());
}

const FittedRegions<LobeIntegrand>& LobeLight::build(const GlossyLobe& lobe, float misfit) {
    return w_.tools.builder.build(
        LobeIntegrand(context_.environment, tables_.cells, context_.cache->header().tiers(),
                      leastNoise_, lobe, misfit),
        lookup_.pooled(), frame_.calibration);
}

const FittedRegions<LobeIntegrand>& LobeLight::match(const PointCluster& cluster,
                                                     std::span<const std::uint32_t> members,
                                                     bool fitted) {
    const GlossyLobe& central = points_[cluster.centre].lobe;
    lookup_.pool(context_.scene, batch_.points[cluster.centre], cluster.radius);
    const LobeMatch match(central);
    float misfit = 0;
    w_.matches.clear();
    for (const std::uint32_t point : members) {
        w_.matches.push_back(match.fit(points_[point].lobe));
        misfit += w_.matches.back().misfit / static_cast<float>(members.size());
        if (!fitted) w_.matches.back().factor = Rgb(0.0f);
    }
    return build(central.widened(kLeastFittedAlpha), fitted ? misfit : 1.0f);
}

const FittedRegions<LobeIntegrand>& LobeLight::regionsOf(const PointCluster& cluster,
                                                         std::span<const std::uint32_t> members) {
    const GlossyLobe& central = points_[cluster.centre].lobe;
    partOfLobes_ = partOfLobes(central);
    return match(cluster, members, central.alpha() >= kLeastFittedAlpha);
}

void LobeLight::roundSamples(std::span<const std::uint32_t> members, double part, RenderSalt salt,
                             std::vector<SampleCount>& counts) {
    w_.tools.wanted.clear();
    for (const std::uint32_t member : members)
        w_.tools.wanted.push_back(batch_.samples * part *
                                  static_cast<double>(batch_.points[member].sampleFraction));
    const ShadingPoint& first = batch_.points[members.front()];
    roundCounts(w_.tools.wanted, toUnit(hashWords(first.seed, salt, first.cameraRay)), counts);
}

const SamplingPlan& LobeLight::plan(const Regions& regions,
                                    std::span<const std::uint32_t> members) {
    roundSamples(members, 1 - partOfLobes_, RenderSalt::glossShare, w_.tools.counts);
    roundSamples(members, partOfLobes_, RenderSalt::glossRounding, w_.lobeCounts);
    for (std::uint32_t k = 0; k < members.size(); ++k) {
        w_.memberOf[members[k]] = k;
        w_.lobeSamples[members[k]] = w_.lobeCounts[k].expected;
    }
    return w_.tools.planner.plan(regions, kJudgedSamples,
                                 {frame_.darkest / kPi, kUnsureShareUniform}, kGlossyHeavy);
}

void LobeLight::addIntegrals(const FittedRegions<LobeIntegrand>& fitted, const SamplingPlan& plan,
                             std::span<const std::uint32_t> members,
                             std::span<Estimate> estimates) const {
    const Rgb integral = integralOf(tables_.cells, fitted, plan);
    for (std::size_t k = 0; k < members.size(); ++k)
        estimates[members[k]].irradiance = integral * w_.matches[k].factor;
}

void LobeLight::trace(const PlannedCluster<LobeIntegrand>& cluster,
                      std::span<const ClusterSample> samples, SampleTracer::Run& run) {
    for (const ClusterSample& sample : samples) {
        const EnvironmentSample s = sample.finish(context_.environment);
        traceOne(cluster, w_.memberOf[sample.point], sample.place, s,
                 static_cast<double>(s.density) * cluster.distribution.light(sample.place), run);
    }
    traceLobes(cluster, run);
}

/// All points draw from one sequence, one after the other.
void LobeLight::traceLobes(const PlannedCluster<LobeIntegrand>& cluster, SampleTracer::Run& run) {
    std::size_t total = 0;
    for (const SampleCount& count : w_.lobeCounts) total += static_cast<std::size_t>(count.drawn);
    if (total == 0) return;
    w_.u.resize(total);
    w_.v.resize(total);
    const ShadingPoint& first = batch_.points[cluster.members.front()];
    const std::uint64_t seed = hashWords(first.seed, RenderSalt::glossLobes, first.cameraRay);
    context_.sequence.fill(0, 0, seed, w_.u);
    context_.sequence.fill(0, 1, seed, w_.v);
    const Environment& environment = context_.environment;
    std::size_t number = 0;
    for (std::uint32_t k = 0; k < cluster.members.size(); ++k) {
        const GlossyLobe& lobe = points_[cluster.members[k]].lobe;
        for (int j = 0; j < w_.lobeCounts[k].drawn; ++j, ++number) {
            const EnvironmentSample s = environment.lookUp(
                lobe.sample(toUnitFloat(w_.u[number]), toUnitFloat(w_.v[number])));
            traceOne(cluster, k, cluster.distribution.find(s.cell), s,
                     static_cast<double>(s.density) * environment.luminanceIntegral(), run);
        }
    }
}

void LobeLight::traceOne(const PlannedCluster<LobeIntegrand>& cluster, std::uint32_t member,
                         const RegionPlace& place, const EnvironmentSample& s, double lightDensity,
                         SampleTracer::Run& run) const {
    const std::uint32_t point = cluster.members[member];
    const GlossyLobe& lobe = points_[point].lobe;
    const double density =
        w_.lobeCounts[member].divisor * static_cast<double>(lobe.density(s.direction)) +
        cluster.counts[member].divisor * cluster.distribution.pdf(place, lightDensity);
    if (!(density > 0)) return run.add(point, Rgb(0.0f));
    const float c = place.found() ? cluster.plan.groups[place.group].visibility[place.lane] : 0.0f;
    Rgb standIn(0.0f);
    if (c > 0) {
        const RegionGroup& group = cluster.fitted.regions.groups[place.group];
        standIn = tables_.cells.value(cluster.fitted.fits[place.group], group.level,
                                      group.firstCell + static_cast<std::uint32_t>(place.lane),
                                      s.direction) *
                  w_.matches[member].factor * c;
    }
    traceSample<LobeIntegrand>(
        cluster.plan, {point, place, s, lightDensity, static_cast<float>(1 / density)},
        s.direction.dot(lobe.normal()) > 0, lobe.value(s.direction), standIn, run);
}

void LobeLight::predict(std::span<Estimate> estimates) {
    PointClusters& clusters = w_.tools.clusters;
    clusters.build(batch_.points, context_.cache->header().spacing, batch_.cameraRays, 0);
    for (const PointCluster& cluster : clusters.clusters()) {
        const std::span<const std::uint32_t> members = clusters.membersOf(cluster);
        const Rgb predicted = predictionOf(tables_.cells, match(cluster, members, true));
        for (std::size_t k = 0; k < members.size(); ++k) {
            Rgb& estimate = estimates[members[k]].irradiance;
            estimate = predicted * w_.matches[k].factor;
            if (w_.matches[k].factor != Rgb(0.0f)) continue;
            const GlossyLobe lobe = points_[members[k]].lobe.widened(kLeastFittedAlpha);
            estimate = predictionOf(tables_.cells, build(lobe, 0));
        }
    }
}

}  // namespace shadowcache
