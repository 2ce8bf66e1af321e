#include "render/estimators/emitter_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/tuned.h"
#include "common/emitters/emitter_ray.h"
#include "render/estimators/emitter_samples.h"

namespace shadowcache {

namespace {

/// Share of an emitter that counts as visible where no ray of the items saw it.
SHADOWCACHE_TUNED(float, kHiddenShare, 0.02f);

/// Most samples of a point that counts for more than others.
SHADOWCACHE_TUNED(double, kMostEmitterSamples, 16);

double unit(std::uint32_t word) {
    return (static_cast<double>(word) + 0.5) * 0x1p-32;
}

}  // namespace

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

/// The same, by the item that counts for a point, if it is known.
void EmitterLight::lookUp(const ShadingPoint& point, Tools& tools) const {
    if (visibility_ && point.slot.item != kNoItem)
        visibility_->shares(point.slot.item, tools.shares_);
    else
        lookUp(point.place, tools);
}

/// Chances of the emitters at a place. @return what they are predicted to light it with, as
/// EmitterPart::weight counts; 0: there are none
float EmitterLight::setChances(const Receiver& at, Tools& tools) const {
    float sum = 0;
    for (std::size_t e = 0; e < emitters_.size(); ++e) {
        const float share = tools.shares_[e];
        const float visible = share < 0 ? 1 : share + kHiddenShare;
        sum += tools.chances_[e] = emitters_.roughWeight(e, at) * visible;
    }
    if (!(sum > 0)) return 0;
    for (float& chance : tools.chances_) chance /= sum;
    return sum;
}

/// The same of all points of a batch.
void EmitterLight::setChancesOfAll(const PointBatch& batch, Tools& tools) const {
    tools.chancesOfAll_.clear();
    tools.predicted_.clear();
    for (const ShadingPoint& point : batch.points) {
        lookUp(point, tools);
        tools.predicted_.push_back(setChances({point.place.rayOrigin, point.place.normal}, tools));
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
    drawn.point = emitters_.sample(t, at, unit(tools.words_[1][k]), unit(tools.words_[2][k]));
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

void EmitterLight::trace(Tools& tools) const {
    if (tools.queued_.empty()) return;
    scene_.trace(tools.stream_, tools.queued_.size());
    for (std::size_t i = 0; i < tools.queued_.size(); ++i) {
        const auto vector = [i](const float(&of)[3][RayStream::kSize]) {
            return Vec3f(of[0][i], of[1][i], of[2][i]);
        };
        const bool visible = tools.stream_.reach[i] >= 0;
        Tools::Sample& sample = tools.samples_[tools.queued_[i]];
        sample.visible = visible;
        if (visible && scene_.tints())
            sample.value *= scene_.tint(vector(tools.stream_.origin),
                                        vector(tools.stream_.direction), tools.stream_.reach[i]);
    }
    tools.queued_.clear();
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
    setChancesOfAll(batch, tools);
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

}  // namespace shadowcache
