#include "render/bounces/guide_maker.h"

#include <algorithm>
#include <utility>

#include "common/base/tuned.h"
#include "common/mesh/placed_mesh.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"

namespace shadowcache {

namespace {

/// Balls that rays may be guided to, of which those are kept that pay.
SHADOWCACHE_TUNED(std::size_t, kGuideBalls, 32);

/// Trial rays to each.
SHADOWCACHE_TUNED(int, kTrialRays, 16);

/// Of these, the first ones, after which no more are sent where they show no gain.
SHADOWCACHE_TUNED(int, kFirstTrialRays, 4);

/// By how much guided rays have to lower the second moment of what a ray finds.
SHADOWCACHE_TUNED(double, kLeastGuideGain, 1.5);

/// Shares of guided rays that are compared.
constexpr double kShares[] = {0.25, 0.5, 0.75};

/// Least chance of a ball, over that of the mean one: trial rays may have missed what lights it.
constexpr double kLeastOfMean = 0.1;

/// Most of the hemisphere that balls count as.
constexpr double kMostExtent = 0.95;

/// Light of all bounces, as BounceSolve::indirect() has it.
constexpr int kAllBounces = -1;

}  // namespace

DirectionGuide GuideMaker::make(std::span<const GuidePlace> places, std::uint64_t seed) {
    Vec3f position(0), normal(0);
    double predicted = 0;
    for (const GuidePlace& place : places) {
        position += place.origin / static_cast<float>(places.size());
        normal += place.normal;
        predicted += predictedAt(place) / static_cast<double>(places.size());
    }
    if (normal.length2() <= 0) return {};
    trials_.clear();
    for (const RadiosityTree::Ball& ball :
         tree_.brightestFor(position, normal.normalized(), kGuideBalls))
        trials_.push_back({ball});
    sendTrials(places, seed, 0, kFirstTrialRays);
    if (best(predicted, 1).share <= 0) return {};
    sendTrials(places, seed, kFirstTrialRays, kTrialRays);
    const auto [kept, share] = best(predicted, kLeastGuideGain);
    if (share <= 0) return {};
    double found = 0, sum = 0;
    for (const Trial& trial : kept) found += trial.light;
    const double least = kLeastOfMean * found / static_cast<double>(kept.size());
    for (const Trial& trial : kept) sum += std::max(trial.light, least);
    std::vector<DirectionGuide::Part> parts;
    parts.reserve(kept.size());
    for (const Trial& trial : kept)
        parts.push_back({trial.ball, static_cast<float>(std::max(trial.light, least) / sum)});
    return {std::move(parts), share};
}

void GuideMaker::sendTrials(std::span<const GuidePlace> places, std::uint64_t seed, int first,
                            int last) {
    for (std::size_t b = 0; b < trials_.size(); ++b)
        for (int i = first; i < last; ++i) {
            const std::uint64_t ray = hashWords(seed, b, static_cast<std::uint64_t>(i));
            const GuidePlace& from = places[ray % places.size()];
            const BallCone cone(trials_[b].ball, from.origin);
            if (cone.empty()) continue;
            const std::uint64_t h = hashWords(ray, RenderSalt::trialRay);
            const Vec3f direction = cone.draw(toUnitFloat(static_cast<std::uint32_t>(h)),
                                              toUnitFloat(static_cast<std::uint32_t>(h >> 32)));
            const float cosine = direction.dot(from.normal);
            if (cosine <= 0 || direction.dot(from.geometricNormal) <= 0) continue;
            queue({b, static_cast<double>(cosine * cone.solidAngle())}, from.origin, direction);
        }
    flush();
    sent_ = last;
}

void GuideMaker::queue(const Queued& ray, const Vec3f& origin, const Vec3f& direction) {
    packet_.set(static_cast<int>(count_), origin, direction);
    queued_[count_++] = ray;
    if (count_ == queued_.size()) flush();
}

void GuideMaker::flush() {
    std::array<Hit, RayPacket::kSize> hits;
    context_.scene.meet(packet_, static_cast<int>(count_), hits.data());
    rays_ += count_;
    for (std::size_t i = 0; i < count_; ++i) {
        const Vec3f direction(packet_.directionX[i], packet_.directionY[i], packet_.directionZ[i]);
        Trial& trial = trials_[queued_[i].ball];
        trial.extent += queued_[i].weight;
        trial.light += queued_[i].weight * static_cast<double>(radianceMet(hits[i], direction));
    }
    count_ = 0;
}

/// Luminance that a hit is predicted to send back along its ray.
float GuideMaker::radianceMet(const Hit& hit, const Vec3f& direction) const {
    if (!hit.found || hit.scene != &context_.scene) return 0;
    const bool back = hit.normal.dot(direction) > 0;
    if (back && !isDoubleSided(context_.scene.mesh(), hit.triangle)) return 0;
    const Vec3f normal = back ? -hit.normal : hit.normal;
    const std::uint32_t item =
        tree_.solve().items().itemAt(context_.scene.mesh().origin + Vec3d(hit.position), normal);
    return item == kNoItem ? 0 : tree_.radianceOf(item) * context_.environment.luminance(hit.tint);
}

/// Luminance of the irradiance that is predicted to bounce to a place.
double GuideMaker::predictedAt(const GuidePlace& place) const {
    const std::uint32_t item = tree_.solve().items().itemAt(
        context_.scene.mesh().origin + Vec3d(place.origin), place.geometricNormal);
    if (item == kNoItem) return 0;
    return static_cast<double>(
        context_.environment.luminance(tree_.solve().indirect(item, kAllBounces)));
}

/// The balls with which the second moment of what a ray finds is least; with f the share of the
/// light that comes from them and a that of the hemisphere, by the cosine, it is f^2 / a +
/// (1 - f)^2 / (1 - a) by the cosine, and f^2 / ((1 - s) a + s) + (1 - f)^2 / ((1 - s) (1 - a))
/// where a share s of the rays goes to them.
///
/// @param predicted  luminance of the irradiance from everywhere
/// @param gain       by how much the second moment has to be lower
GuideMaker::Best GuideMaker::best(double predicted, double gain) const {
    Best found{trials_, 0};
    std::vector<Trial>& trials = found.trials;
    std::erase_if(trials, [](const Trial& t) { return !(t.light > 0 && t.extent > 0); });
    std::ranges::stable_sort(trials, [](const Trial& a, const Trial& b) {
        return a.light * b.extent > b.light * a.extent;
    });
    double all = 0;
    for (const Trial& trial : trials) all += trial.light / sent_;
    const double whole = std::max(predicted, all);
    double least = 1 / gain, part = 0, extent = 0;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        part += trials[i].light / sent_ / whole;
        extent = std::min(extent + trials[i].extent / sent_ / kPi, kMostExtent);
        const double rest = (1 - part) * (1 - part) / (1 - extent);
        const double unguided = part * part / extent + rest;
        for (const double share : kShares) {
            const double guided = part * part / ((1 - share) * extent + share) + rest / (1 - share);
            if (!(guided < least * unguided)) continue;
            least = guided / unguided;
            kept = i + 1;
            found.share = static_cast<float>(share);
        }
    }
    trials.resize(kept);
    return found;
}

}  // namespace shadowcache
