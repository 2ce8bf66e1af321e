#include "render/estimators/light_groups.h"

#include <algorithm>

#include "common/mesh/placed_mesh.h"

namespace shadowcache {

LightGroups::LightGroups(std::span<const LightGroupRule> rules, const TriangleMesh& mesh,
                         const Emitters* emitters)
    : mesh_(mesh), rules_(rules.begin(), rules.end()), names_(lightGroupNames(rules, mesh)) {
    for (const Material& material : mesh.materials)
        ofMaterial_.push_back(lightGroupOf(material.name, rules_, names_));
    if (!emitters) return;
    std::vector<std::size_t> ofLamp;
    for (const Lamp& lamp : mesh.lamps) ofLamp.push_back(lightGroupOf(lamp.name, rules_, names_));
    for (const EmitterPart& part : emitters->parts())
        ofPart_.push_back(part.isSurface() ? ofMaterial(materialOf(
                                                 mesh, placedTriangle(mesh, part.placed).triangle))
                                           : ofLamp[part.lamp]);
    for (std::size_t e = 0; e < emitters->size(); ++e) {
        const std::span<const EmitterPart> parts = emitters->partsOf(e);
        shares_.push_back(
            sharesOf(parts, static_cast<std::size_t>(parts.data() - emitters->parts().data())));
    }
}

std::size_t LightGroups::ofMaterial(const Material* material) const {
    if (!material) return names_.size() - 1;
    return ofMaterial_[static_cast<std::size_t>(material - mesh_.materials.data())];
}

std::size_t LightGroups::ofHit(const Hit& hit) const {
    const TriangleMesh& mesh = hit.scene->mesh();
    const Material* material = materialOf(mesh, placedTriangle(mesh, hit.triangle).triangle);
    if (&mesh == &mesh_ || !material) return ofMaterial(material);
    return lightGroupOf(material->name, rules_, names_);
}

std::vector<LightGroups::Share> LightGroups::sharesOf(std::span<const EmitterPart> parts,
                                                      std::size_t first) const {
    std::vector<Share> shares;
    Rgb all(0, 0, 0);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::size_t group = ofPart_[first + i];
        auto share = std::ranges::find(shares, group, &Share::group);
        if (share == shares.end()) share = shares.insert(share, {group, Rgb(0, 0, 0)});
        share->part += parts[i].radiance * parts[i].area;
        all += parts[i].radiance * parts[i].area;
    }
    if (shares.size() == 1) return {{shares.front().group, Rgb(1, 1, 1)}};
    for (Share& share : shares)
        for (int c = 0; c < 3; ++c) share.part[c] = all[c] > 0 ? share.part[c] / all[c] : 0;
    return shares;
}

void LightGroups::add(std::size_t emitter, const Rgb& irradiance, float factor,
                      std::span<Rgb> light) const {
    for (const Share& share : shares_[emitter])
        light[share.group] += irradiance * factor * share.part;
}

void GroupSink::add(std::size_t place, std::size_t group, const Rgb& value, float factor) const {
    at(place)[group] += value * factor;
}

}  // namespace shadowcache
