#include "render/library/set_light.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/cache/emitter_code.h"
#include "common/cache/transport.h"

namespace shadowcache {

static_assert(kMostEmitters == kMostEmittersOfCache);

std::unique_ptr<SetLight> SetLight::of(const Scene& scene, const ShadowCache* cache) {
    const TriangleMesh* const meshes[] = {&scene.mesh()};
    Emitters emitters(meshes);
    if (emitters.empty()) return nullptr;
    std::unique_ptr<SetLight> light(new SetLight(scene, std::move(emitters)));
    if (cache) light->readCounts(*cache);
    light->light_.emplace(scene, light->emitters_, cache,
                          light->visibility_ ? &*light->visibility_ : nullptr);
    return light;
}

SetLight::SetLight(const Scene& scene, Emitters emitters)
    : scene_(scene), emitters_(std::move(emitters)) {}

/// The counts of an emitter are those of the one of the same shape and place.
void SetLight::readCounts(const ShadowCache& cache) {
    const std::vector<std::uint64_t>& counted = cache.header().emitters;
    std::vector<std::size_t> columns;
    std::size_t known = 0;
    for (std::size_t e = 0; e < emitters_.size(); ++e) {
        const auto found = std::ranges::find(counted, emitters_.shapeOf(e));
        known += found != counted.end() ? 1 : 0;
        columns.push_back(static_cast<std::size_t>(found - counted.begin()));
    }
    knowsAll_ = known == emitters_.size();
    if (known == 0) return;
    const std::vector<std::uint16_t> codes = readEmitterCodes(cache);
    const std::size_t items = codes.size() / counted.size();
    std::vector<EmitterVisibility::Count> counts(items * emitters_.size());
    for (std::size_t i = 0; i < items; ++i)
        for (std::size_t e = 0; e < emitters_.size(); ++e) {
            if (columns[e] == counted.size()) continue;
            const std::uint16_t code = codes[i * counted.size() + columns[e]];
            counts[i * emitters_.size() + e] = {
                static_cast<std::uint8_t>(EmitterCode::visible(code)),
                static_cast<std::uint8_t>(EmitterCode::rays(code))};
        }
    visibility_.emplace(emitters_.size(), std::move(counts));
}

template <class Visit>
void SetLight::forEachItem(const ItemTable& items, const Visit& visit) const {
    parallelFor(items.size(), 1024, [&](const Chunk& chunk) {
        EmitterLight::Tools tools(*light_);
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const auto item = static_cast<std::uint32_t>(i);
            const Vec3d place = items.position(item) - scene_.mesh().origin;
            visit(i, Receiver{Vec3f(place), items.normal(item)}, tools);
        }
    });
}

std::vector<Rgb> SetLight::predictItems(const ItemTable& items) const {
    if (!knowsAll_) return {};
    std::vector<Rgb> irradiance(items.size());
    forEachItem(items, [&](std::size_t i, const Receiver& place, EmitterLight::Tools& tools) {
        irradiance[i] = light_->predictItem(i, place, tools);
    });
    return irradiance;
}

std::vector<std::vector<Rgb>> SetLight::predictItems(const ItemTable& items,
                                                     const LightGroups& groups) const {
    GroupedLight light(items.size(), groups.size());
    forEachItem(items, [&](std::size_t i, const Receiver& place, EmitterLight::Tools& tools) {
        light_->predictItem(i, place, tools, {&groups, &light});
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
