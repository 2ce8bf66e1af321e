// What rays of lobes and of cameras meet of emitters, and lobes' rays to them.

#include <array>
#include <limits>

#include "common/mesh/placed_mesh.h"
#include "render/estimators/emitter_light.h"
#include "render/estimators/emitter_samples.h"
#include "render/estimators/set_place.h"

namespace shadowcache {

/// What a surface that a lobe's ray met adds to the lobe, by its density with that of draw().
Rgb EmitterLight::emissionOverDensity(const Hit& hit, const Receiver& at, bool draws, float density,
                                      const Tools& tools) const {
    const std::ptrdiff_t found = emitters_.find(0, hit.triangle);
    if (draws && found >= 0) {
        const auto part = static_cast<std::size_t>(found);
        density += chanceOf(part, at, tools) *
                   emitters_.densityAt(emitters_.parts()[part], at, hit.position);
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
        lookUp(point, tools);
        const bool draws = setChances(at, tools) > 0;
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
                const Rgb ofSurface = emissionOverDensity(hit, at, draws, ray.density, tools);
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
    lookUp(glossy.point, tools);
    if (!(setChances(at, tools) > 0)) return {0, 0, 0};
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
