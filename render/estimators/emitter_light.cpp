#include "render/estimators/emitter_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/tuned.h"
#include "common/emitters/emitter_ray.h"
#include "common/mesh/placed_mesh.h"
#include "common/random/salts.h"
#include "common/random/sequence.h"
#include "render/estimators/set_place.h"

namespace shadowcache {

namespace {

/// Share of an emitter that counts as visible where no ray of the items saw it.
SHADOWCACHE_TUNED(float, kHiddenShare, 0.02f);

/// Most samples of a point that counts for more than others.
SHADOWCACHE_TUNED(double, kMostEmitterSamples, 16);

/// Samples of a point: fewer of those that more camera rays of a pixel than asked for met.
int samplesOf(const PointBatch& batch, const BatchSlot& slot) {
    const float wanted = static_cast<float>(batch.samples) * slot.sampleFraction;
    return std::max(1, static_cast<int>(std::lround(wanted)));
}

/// Words of the samples of a point among those of its pixel.
void fillWords(const BatchSlot& slot, RenderSalt salt, int samples,
               std::vector<std::uint32_t> (&words)[3]) {
    const std::uint64_t seed = hashWords(slot.seed, salt);
    const std::uint32_t first = slot.cameraRay * static_cast<std::uint32_t>(samples);
    for (int d = 0; d < 3; ++d) {
        words[d].resize(static_cast<std::size_t>(samples));
        owenSobol(first, d, seed, words[d]);
    }
}

double unit(std::uint32_t word) {
    return (static_cast<double>(word) + 0.5) * 0x1p-32;
}

/// Adds up values of samples that estimate the same thing, and the variance of their sum: the
/// squared difference of two neighbours estimates that of theirs.
struct Sum {
    const Rgb& luminanceWeights;
    Rgb value{0, 0, 0};
    float variance = 0;
    Rgb before{0, 0, 0};
    bool odd = false;

    void add(const Rgb& sample) {
        value += sample;
        if (odd) {
            const float difference = (sample - before).dot(luminanceWeights);
            variance += difference * difference;
        }
        before = sample;
        odd = !odd;
    }
};

}  // namespace

/// A direction to an emitter.
struct EmitterLight::Drawn {
    const EmitterPart* part = nullptr;  ///< null: none
    EmitterPoint point;
    Rgb radiance{0, 0, 0};
    float density = 0;  ///< of the direction, by all that chose it [1/sr]

    /// Density with which it may be found, a ray that knows no emitter included, which does not
    /// find a single direction.
    float densityWith(float other) const { return density + (point.isSingle ? 0 : other); }
};

EmitterLight::EmitterLight(const Scene& scene, const Emitters& emitters, const ShadowCache* cache,
                           const EmitterVisibility* visibility)
    : scene_(scene), emitters_(emitters), cache_(cache), visibility_(visibility) {}

EmitterLight::Tools::Tools(const EmitterLight& light)
    : items_(ShadowCache::kMaxItems),
      shares_(light.emitters_.size(), EmitterVisibility::kUnknown),
      chances_(light.emitters_.size()) {
    if (light.visibility_) reader_.emplace(*light.cache_);
    queued_.reserve(RayStream::kSize);
}

void EmitterLight::lookUp(const SetPlace& place, Tools& tools) const {
    if (!visibility_) return;
    const int found = tools.reader_->lookUp(place.position, place.geometricNormal, tools.items_);
    visibility_->shares(std::span(tools.items_).first(static_cast<std::size_t>(found)),
                        tools.shares_);
}

/// Chances of the emitters at a place. @return what they are predicted to light it with, as
/// EmitterPart::weight counts; 0: there are none
float EmitterLight::weigh(const Receiver& at, Tools& tools) const {
    float sum = 0;
    for (std::size_t e = 0; e < emitters_.size(); ++e) {
        const float share = tools.shares_[e];
        const float visible = share < 0 ? 1 : share + kHiddenShare;
        sum += tools.chances_[e] = emitters_.irradiance(e, at).weight * visible;
    }
    if (!(sum > 0)) return 0;
    for (float& chance : tools.chances_) chance /= sum;
    return sum;
}

/// The same of all points of a batch.
void EmitterLight::weighAll(const PointBatch& batch, Tools& tools) const {
    tools.chancesOfAll_.clear();
    tools.predicted_.clear();
    for (const ShadingPoint& point : batch.points) {
        lookUp(point.place, tools);
        tools.predicted_.push_back(weigh({point.place.rayOrigin, point.place.normal}, tools));
        tools.chancesOfAll_.insert(tools.chancesOfAll_.end(), tools.chances_.begin(),
                                   tools.chances_.end());
    }
}

/// The direction that a place's words `k` decide.
EmitterLight::Drawn EmitterLight::draw(const Receiver& at, std::size_t k,
                                       const Tools& tools) const {
    Drawn drawn;
    double choice = unit(tools.words_[0][k]);
    std::size_t e = 0, last = 0;
    for (; e < tools.chances_.size(); ++e) {
        const auto chance = static_cast<double>(tools.chances_[e]);
        if (chance > 0) last = e;
        if (choice < chance) break;
        choice -= chance;
    }
    // Rounding may leave something behind the last one.
    if (e == tools.chances_.size()) e = last;
    choice = std::clamp(choice / static_cast<double>(tools.chances_[e]), 0.0, 1 - 0x1p-53);
    const Emitters::Choice chosen = emitters_.choose(e, at, choice);
    if (!(chosen.chance > 0)) return drawn;
    const EmitterPart& t = emitters_.parts()[chosen.part];
    drawn.point = samplePoint(t, at, unit(tools.words_[1][k]), unit(tools.words_[2][k]));
    drawn.density = tools.chances_[e] * chosen.chance * drawn.point.density;
    if (!(drawn.density > 0)) return drawn;
    drawn.part = &t;
    drawn.radiance = emitters_.radianceAt(t, drawn.point);
    return drawn;
}

/// Chance of a part of an emitter at a place.
float EmitterLight::chanceOf(std::size_t part, const Receiver& at, const Tools& tools) const {
    const float chance = tools.chances_[emitters_.emitterOf(part)];
    return chance > 0 ? chance * emitters_.chanceOf(part, at) : 0;
}

std::size_t EmitterLight::numberOf(const Drawn& drawn) const {
    return drawn.part ? static_cast<std::size_t>(drawn.part - emitters_.parts().data()) : 0;
}

/// What a surface that a lobe's ray met adds to the lobe, by its density with that of draw().
Rgb EmitterLight::weighed(const Hit& hit, const Receiver& at, bool draws, float density,
                          const Tools& tools) const {
    const std::ptrdiff_t found = emitters_.find(0, hit.triangle);
    if (draws && found >= 0) {
        const auto part = static_cast<std::size_t>(found);
        density += chanceOf(part, at, tools) * densityAt(emitters_.parts()[part], at, hit.position);
    }
    return surfaceSeen(hit, {}).emission * (1 / density);
}

/// Visits lamps that a ray meets up to a distance, with the tint of panes before them.
///
/// @param met  scratch memory
template <class Visit>
void EmitterLight::forLampsOf(const Receiver& at, const Vec3f& direction, float distance,
                              std::vector<Emitters::Met>& met, const Visit& visit) const {
    met.clear();
    emitters_.meetLamps(at, direction, met);
    for (const auto& [part, hit] : met) {
        if (hit.distance > distance) continue;
        visit(part, hit,
              scene_.tints() ? scene_.tint(at.position, direction, hit.distance) : Rgb(1, 1, 1));
    }
}

/// The same of the lamps that it met on its way, which do not stop it.
Rgb EmitterLight::lampsMet(const Tools::LobeRay& ray, float distance, const Receiver& at,
                           Tools& tools, const GroupSink& sink) const {
    Rgb sum(0, 0, 0);
    const auto add = [&](std::uint32_t part, const LampHit& hit, const Rgb& tint) {
        const float density = ray.density + chanceOf(part, at, tools) * hit.density;
        const Rgb met = hit.radiance * (1 / density) * tint;
        sum += met;
        if (sink) sink.at(ray.point)[sink.groups->ofPart(part)] += ray.value * met;
    };
    forLampsOf(at, ray.direction, distance, tools.met_, add);
    return sum;
}

std::vector<EmitterLight::SeenLamp> EmitterLight::lampsSeen(const Vec3f& origin,
                                                            const Vec3f& direction,
                                                            float distance) const {
    std::vector<SeenLamp> seen;
    if (!emitters_.hasSeenLamps()) return seen;
    std::vector<Emitters::Met> met;
    forLampsOf({origin, direction}, direction, distance, met,
               [&](std::uint32_t part, const LampHit& hit, const Rgb& tint) {
                   if (emitters_.parts()[part].seenByCamera)
                       seen.push_back({part, hit.distance, hit.radiance * tint});
               });
    return seen;
}

void EmitterLight::enqueue(const SetPlace& place, const Drawn& drawn, const Rgb& value,
                           std::uint32_t number, Tools& tools) const {
    const bool seen = value != Rgb(0, 0, 0) && drawn.point.direction.dot(place.geometricNormal) > 0;
    tools.samples_.push_back({number, seen, false, value, numberOf(drawn)});
    if (!seen) return;
    const EmitterRay ray = rayTo(scene_, *drawn.part, drawn.point, place.rayOrigin);
    const std::size_t i = tools.queued_.size();
    for (int k = 0; k < 3; ++k) {
        tools.stream_.origin[k][i] = place.rayOrigin[k];
        tools.stream_.direction[k][i] = ray.way[k];
    }
    tools.stream_.reach[i] = ray.reach;
    tools.queued_.push_back(static_cast<std::uint32_t>(tools.samples_.size() - 1));
    if (tools.queued_.size() == RayStream::kSize) trace(tools);
}

/// Whether nothing is in the way of a ray of rayTo(), of what moves, too.
bool EmitterLight::passes(const Vec3f& origin, const Vec3f& way, float reach) const {
    if (std::isfinite(reach)) return scene_.isFree(origin, way);
    RayPacket ray{};
    ray.set(0, origin, way);
    return scene_.visibility(ray, 1) != 0;
}

void EmitterLight::trace(Tools& tools) const {
    if (tools.queued_.empty()) return;
    scene_.trace(tools.stream_, tools.queued_.size());
    // Streams do not see what moves.
    const bool moves = !scene_.movingBalls().empty();
    for (std::size_t i = 0; i < tools.queued_.size(); ++i) {
        const auto vector = [i](const float(&of)[3][RayStream::kSize]) {
            return Vec3f(of[0][i], of[1][i], of[2][i]);
        };
        bool visible = tools.stream_.reach[i] >= 0;
        if (visible && moves)
            visible = passes(vector(tools.stream_.origin), vector(tools.stream_.direction),
                             tools.stream_.reach[i]);
        Tools::Sample& sample = tools.samples_[tools.queued_[i]];
        sample.visible = visible;
        if (visible && scene_.tints())
            sample.value *= scene_.tint(vector(tools.stream_.origin),
                                        vector(tools.stream_.direction), tools.stream_.reach[i]);
    }
    tools.queued_.clear();
}

/// Adds the samples of each point to its estimate.
template <class Samples, class Add>
void EmitterLight::addUp(const Samples& samples, const Rgb& luminanceWeights, const Add& add) {
    for (std::size_t k = 0; k < samples.size();) {
        const std::uint32_t point = samples[k].point;
        Sum sum{luminanceWeights};
        std::uint32_t rays = 0;
        for (; k < samples.size() && samples[k].point == point; ++k) {
            sum.add(samples[k].visible ? samples[k].value : Rgb(0, 0, 0));
            rays += samples[k].traced ? 1 : 0;
        }
        add(point, sum.value, sum.variance, rays);
    }
}

/// Adds the samples that go to emitters to their groups.
void EmitterLight::addToGroups(const Tools& tools, const GroupSink& sink) {
    if (!sink) return;
    for (const Tools::Sample& sample : tools.samples_)
        if (sample.visible) sink.at(sample.point)[sink.groups->ofPart(sample.part)] += sample.value;
}

void EmitterLight::addIrradiance(const PointBatch& batch, const Rgb& luminanceWeights, Tools& tools,
                                 std::span<Estimate> estimates, const GroupSink& sink) const {
    tools.samples_.clear();
    weighAll(batch, tools);
    // A few points are most of what all of a batch add to pictures.
    const auto importance = [&](std::size_t i) {
        return static_cast<double>(tools.predicted_[i] * batch.points[i].slot.importance);
    };
    double whole = 0;
    for (std::size_t i = 0; i < batch.points.size(); ++i) whole += importance(i);
    const double mean = whole / static_cast<double>(batch.points.size());
    for (std::size_t i = 0; i < batch.points.size(); ++i) {
        if (!(tools.predicted_[i] > 0)) continue;
        const ShadingPoint& point = batch.points[i];
        const Receiver at{point.place.rayOrigin, point.place.normal};
        const std::size_t count = tools.chances_.size();
        std::ranges::copy(std::span(tools.chancesOfAll_).subspan(i * count, count),
                          tools.chances_.begin());
        const double more = mean > 0 ? importance(i) / mean : 1;
        const int samples = samplesOf(batch, point.slot) *
                            static_cast<int>(std::clamp(std::ceil(more), 1.0, kMostEmitterSamples));
        fillWords(point.slot, RenderSalt::emitterSamples, samples, tools.words_);
        for (std::size_t k = 0; k < static_cast<std::size_t>(samples); ++k) {
            const Drawn drawn = draw(at, k, tools);
            const float cosine = std::max(0.0f, at.normal.dot(drawn.point.direction));
            const Rgb value =
                drawn.part
                    ? drawn.radiance * (cosine / (drawn.density * static_cast<float>(samples)))
                    : Rgb(0, 0, 0);
            enqueue(point.place, drawn, value, static_cast<std::uint32_t>(i), tools);
        }
    }
    trace(tools);
    addToGroups(tools, sink);
    addUp(tools.samples_, luminanceWeights,
          [&](std::uint32_t i, const Rgb& sum, float variance, std::uint32_t rays) {
              estimates[i].irradiance += sum;
              estimates[i].variance += variance;
              estimates[i].rays += rays;
          });
}

void EmitterLight::addGloss(const PointBatch& batch, std::span<const GlossyPoint> points,
                            const Rgb& luminanceWeights, Tools& tools,
                            std::span<GlossEstimate> estimates, const GroupSink& sink) const {
    tools.samples_.clear();
    tools.lobeRays_.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto number = static_cast<std::uint32_t>(i);
        const ShadingPoint& point = points[i].point;
        const GlossyLobe& lobe = points[i].lobe;
        const Receiver at{point.place.rayOrigin, lobe.normal()};
        lookUp(point.place, tools);
        const bool draws = weigh(at, tools) > 0;
        // As many rays of either kind.
        const int samples = (samplesOf(batch, point.slot) + 1) / 2;
        const float share = 1 / static_cast<float>(samples);
        fillWords(point.slot, RenderSalt::emitterGloss, draws ? samples : 0, tools.words_);
        for (std::size_t k = 0; k < tools.words_[0].size(); ++k) {
            const Drawn drawn = draw(at, k, tools);
            Rgb value(0, 0, 0);
            if (drawn.part)
                value = drawn.radiance * lobe.value(drawn.point.direction) *
                        (share / drawn.densityWith(lobe.density(drawn.point.direction)));
            enqueue(point.place, drawn, value, number, tools);
        }
        fillWords(point.slot, RenderSalt::emitterLobe, samples, tools.words_);
        const std::size_t first = tools.lobeRays_.size();
        for (std::size_t k = 0; k < static_cast<std::size_t>(samples); ++k)
            tools.lobeRays_.push_back(lobeRay(points[i], number, share, k, tools));
        // While the chances are this point's. No ray decides about another.
        traceLobe(at, draws, std::span(tools.lobeRays_).subspan(first), tools, sink);
    }
    trace(tools);
    addToGroups(tools, sink);
    const auto add = [&](std::uint32_t i, const Rgb& sum, float variance, std::uint32_t rays) {
        estimates[i].radiance += sum;
        estimates[i].variance += variance;
        estimates[i].rays += rays;
    };
    addUp(tools.samples_, luminanceWeights, add);
    addUp(tools.lobeRays_, luminanceWeights, add);
}

EmitterLight::Tools::LobeRay EmitterLight::lobeRay(const GlossyPoint& glossy, std::uint32_t number,
                                                   float share, std::size_t k, const Tools& tools) {
    Tools::LobeRay ray;
    ray.point = number;
    ray.direction =
        glossy.lobe.sample(toUnitFloat(tools.words_[0][k]), toUnitFloat(tools.words_[1][k]));
    ray.density = glossy.lobe.density(ray.direction);
    if (!(ray.density > 0) || !(ray.direction.dot(glossy.point.place.geometricNormal) > 0))
        return ray;
    ray.value = glossy.lobe.value(ray.direction) * share;
    ray.traced = ray.value != Rgb(0, 0, 0);
    return ray;
}

/// Traces rays of one point's lobe, and weighs what they find against the rays to emitters.
void EmitterLight::traceLobe(const Receiver& at, bool draws, std::span<Tools::LobeRay> rays,
                             Tools& tools, const GroupSink& sink) const {
    RayPacket packet{};
    std::array<Tools::LobeRay*, RayPacket::kSize> of{};
    std::array<Hit, RayPacket::kSize> hits;
    int count = 0;
    const auto flush = [&] {
        if (count > 0) scene_.meet(packet, count, hits.data());
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            Tools::LobeRay& ray = *of[i];
            const Hit& hit = hits[i];
            const float distance =
                hit.found ? hit.distance : std::numeric_limits<float>::infinity();
            Rgb met = draws ? lampsMet(ray, distance, at, tools, sink) : Rgb(0, 0, 0);
            // What moves is met by the rays of paths.
            const bool back = hit.found && hit.normal.dot(ray.direction) > 0;
            if (hit.found && hit.scene == &scene_ &&
                (!back || isDoubleSided(scene_.mesh(), hit.triangle))) {
                const Rgb ofSurface = weighed(hit, at, draws, ray.density, tools);
                met += ofSurface;
                if (sink && ofSurface != Rgb(0, 0, 0))
                    sink.at(ray.point)[sink.groups->ofHit(hit)] += ray.value * ofSurface;
            }
            ray.value *= met;
            ray.visible = true;
        }
        count = 0;
    };
    for (Tools::LobeRay& ray : rays) {
        if (!ray.traced) continue;
        of[static_cast<std::size_t>(count)] = &ray;
        packet.set(count++, at.position, ray.direction);
        if (count == RayPacket::kSize) flush();
    }
    flush();
}

Rgb EmitterLight::predictGloss(const GlossyPoint& glossy, Tools& tools, const GroupSink& sink,
                               std::size_t number) const {
    constexpr int kDirections = 8;
    const Receiver at{glossy.point.place.rayOrigin, glossy.lobe.normal()};
    lookUp(glossy.point.place, tools);
    if (!(weigh(at, tools) > 0)) return {0, 0, 0};
    fillWords(glossy.point.slot, RenderSalt::emitterGuess, kDirections, tools.words_);
    Rgb sum(0, 0, 0);
    for (std::size_t k = 0; k < kDirections; ++k) {
        const Drawn drawn = draw(at, k, tools);
        if (!drawn.part) continue;
        const std::size_t part = numberOf(drawn);
        const float share = tools.shares_[emitters_.emitterOf(part)];
        const Rgb value = drawn.radiance * glossy.lobe.value(drawn.point.direction);
        const float factor = (share < 0 ? 1 : share) / (drawn.density * kDirections);
        sum += value * factor;
        if (sink) sink.add(number, sink.groups->ofPart(part), value, factor);
    }
    return sum;
}

}  // namespace shadowcache
