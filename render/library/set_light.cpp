#include "render/library/set_light.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "common/cache/emitter_code.h"
#include "common/cache/transport.h"
#include "common/emitters/emitter_label.h"
#include "common/math/vec.h"

namespace shadowcache {

static_assert(kMostEmitters == kMostEmittersOfCache);

namespace {

/// Items that a thread takes at a time.
constexpr std::size_t kItemsOfChunk = 1024;

/// From so many times the mean item's light on, the middle of an item may be so near a lamp that
/// its light is not that of the item.
SHADOWCACHE_TUNED(double, kBright, 4);

/// Places along a side of such an item, which count alike.
constexpr int kPlacesOfSide = 4;

/// Places all over a square around an item's middle.
void spread(const Receiver& middle, float side, std::vector<Receiver>& places) {
    Vec3f s, t;
    tangentFrame(middle.normal, s, t);
    const auto along = [side](int k) {
        return side * ((static_cast<float>(k) + 0.5f) / kPlacesOfSide - 0.5f);
    };
    places.clear();
    places.reserve(std::size_t{kPlacesOfSide} * kPlacesOfSide);
    for (int i = 0; i < kPlacesOfSide; ++i)
        for (int k = 0; k < kPlacesOfSide; ++k)
            places.push_back({middle.position + s * along(i) + t * along(k), middle.normal});
}

Emitters emittersOf(const Scene& scene) {
    const TriangleMesh* const meshes[] = {&scene.mesh()};
    return Emitters(meshes);
}

}  // namespace

std::unique_ptr<SetLight> SetLight::of(const Scene& scene, const ShadowCache* cache) {
    Emitters emitters = emittersOf(scene);
    if (emitters.empty()) return nullptr;
    return std::unique_ptr<SetLight>(new SetLight(scene, cache, std::move(emitters)));
}

SetLight::SetLight(const Scene& scene, const ShadowCache* cache, Emitters emitters)
    : scene_(scene), cache_(cache), emitters_(std::move(emitters)) {
    if (cache_) readCounts(*cache_);
    light_.emplace(scene_, emitters_, cache_, visibility_ ? &*visibility_ : nullptr);
}

void SetLight::moveLamps() {
    light_.reset();
    emitters_ = emittersOf(scene_);
    light_.emplace(scene_, emitters_, cache_, visibility_ ? &*visibility_ : nullptr);
}

/// The counts of an emitter are those of the one of the same shape and place.
void SetLight::readCounts(const ShadowCache& cache) {
    const std::vector<std::uint64_t>& counted = cache.header().emitters;
    std::vector<std::size_t> columns;
    for (std::size_t e = 0; e < emitters_.size() && !emitters_.moves(e); ++e) {
        const auto found = std::ranges::find(counted, emitters_.shapeOf(e));
        if (found == counted.end()) unknown_.push_back(e);
        columns.push_back(static_cast<std::size_t>(found - counted.begin()));
    }
    const std::size_t still = columns.size();
    knowsAll_ = unknown_.empty();
    if (unknown_.size() == still) return;
    const std::vector<std::uint16_t> codes = readEmitterCodes(cache);
    const std::size_t items = codes.size() / counted.size();
    std::vector<EmitterVisibility::Count> counts(items * still);
    for (std::size_t i = 0; i < items; ++i)
        for (std::size_t e = 0; e < still; ++e) {
            if (columns[e] == counted.size()) continue;
            const std::uint16_t code = codes[i * counted.size() + columns[e]];
            counts[i * still + e] = {static_cast<std::uint8_t>(EmitterCode::visible(code)),
                                     static_cast<std::uint8_t>(EmitterCode::rays(code))};
        }
    visibility_.emplace(still, std::move(counts));
}

bool SetLight::countsNone() const {
    return cache_ && cache_->header().emitters.empty();
}

std::string SetLight::unknownText() const {
    if (unknown_.empty()) return "";
    if (countsNone())
        return "counts no emitters: it was baked with --no-lamps, before the set had any, or by a "
               "program that counted none";
    constexpr const char* kWhy = "moved, reshaped or added since the bake";
    const std::string first = emitterLabel(emitters_, unknown_.front());
    if (unknown_.size() == 1)
        return fmt::format("does not count {} where it is: it was {}", first, kWhy);
    return fmt::format("does not count {} of {} emitters where they are, first {}: they were {}",
                       unknown_.size(), emitters_.size(), first, kWhy);
}

std::vector<bool> SetLight::brightItems(const ItemTable& items) const {
    std::vector<float> light(items.size());
    parallelFor(items.size(), kItemsOfChunk, [&](const Chunk& chunk) {
        EmitterLight::Tools tools(*light_);
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const Rgb found = light_->predictItem(i, placeOf(items, i), tools);
            light[i] = found.x + found.y + found.z;
        }
    });
    double mean = 0;
    for (const float found : light) mean += static_cast<double>(found);
    mean /= static_cast<double>(std::max<std::size_t>(1, light.size()));
    std::vector<bool> bright(items.size());
    for (std::size_t i = 0; i < light.size(); ++i)
        bright[i] = static_cast<double>(light[i]) > kBright * mean;
    return bright;
}

Receiver SetLight::placeOf(const ItemTable& items, std::size_t item) const {
    const auto number = static_cast<std::uint32_t>(item);
    return {Vec3f(items.position(number) - scene_.mesh().origin), items.normal(number)};
}

template <class Visit>
void SetLight::forEachItem(const ItemTable& items, const Visit& visit) const {
    const std::vector<bool> bright = brightItems(items);
    const auto side = static_cast<float>(items.spacing());
    parallelFor(items.size(), kItemsOfChunk, [&](const Chunk& chunk) {
        EmitterLight::Tools tools(*light_);
        std::vector<Receiver> places;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const Receiver middle = placeOf(items, i);
            places.assign(1, middle);
            if (bright[i]) spread(middle, side, places);
            visit(i, std::span<const Receiver>(places), tools);
        }
    });
}

std::vector<Rgb> SetLight::predictItems(const ItemTable& items) const {
    if (!knowsAll_ || !visibility_) return {};
    std::vector<Rgb> irradiance(items.size(), Rgb(0, 0, 0));
    forEachItem(items, [&](std::size_t i, std::span<const Receiver> places, auto& tools) {
        for (const Receiver& place : places) irradiance[i] += light_->predictItem(i, place, tools);
        irradiance[i] *= 1 / static_cast<float>(places.size());
    });
    return irradiance;
}

std::vector<std::vector<Rgb>> SetLight::predictItems(const ItemTable& items,
                                                     const LightGroups& groups) const {
    GroupedLight light(items.size(), groups.size());
    forEachItem(items, [&](std::size_t i, std::span<const Receiver> places, auto& tools) {
        for (const Receiver& place : places)
            light_->predictItem(i, place, tools, {&groups, &light});
        for (Rgb& ofGroup : light[i]) ofGroup *= 1 / static_cast<float>(places.size());
    });
    std::vector<std::vector<Rgb>> byGroup(groups.size());
    for (std::size_t g = LightGroups::kSky + 1; g < groups.size(); ++g)
        for (std::size_t i = 0; i < items.size(); ++i) byGroup[g].push_back(light[i][g]);
    return byGroup;
}

void refuseEmitters(const EstimatorEntry& estimator, const SetLight& light) {
    std::string known;
    for (const EstimatorEntry& entry : estimatorTable())
        if (entry.lit) known += (known.empty() ? "" : ", ") + std::string(entry.name);
    throw Error(
        fmt::format("--estimator {}: leaves out the light of the set's {} emitters; expected "
                    "one of {}, or --lamps off, with which nothing shines",
                    estimator.name, light.emitters().size(), known));
}

}  // namespace shadowcache
