#include "common/import/obj_material.h"

#include <algorithm>
#include <cmath>

namespace shadowcache {

namespace {

/// Ns of a mirror. Blender and Assimp: roughness = 1 - sqrt(Ns / 1000).
constexpr float kMirrorExponent = 1000;
/// Reflectance at normal incidence of Ks = 1, as Blender has it; glTF's dielectric has half of it.
constexpr float kSpecularReflectance = 0.08f, kDielectricReflectance = 0.04f;

/// A colour times a picture: black beside a picture is what programs write that mean the picture.
Rgb beside(const MtlMap* map, const std::optional<Rgb>& color, const Rgb& fallback) {
    if (!color) return map ? Rgb(1.0f) : fallback;
    return map && *color == Rgb(0.0f) ? Rgb(1.0f) : *color;
}

/// Lookups scale * (u, v) + offset, v upwards, in texture coordinates whose t points down.
GltfTexturePlace placeOf(const MtlMap& map) {
    GltfTexturePlace place;
    place.toS = Vec3d(Vec3f(map.scale[0], 0, map.offset[0]));
    place.toT = Vec3d(Vec3f(0, -map.scale[1], 1 - map.offset[1]));
    return place;
}

class Maker {
public:
    Maker(const MtlMaterial& from, const std::filesystem::path& library, ObjPictures& pictures)
        : from_(from), library_(library), pictures_(pictures) {
        to_.name = from.name;
        to_.leftOut = from.leftOut;
        to_.clamped = from.clamped;
        // The base colour's, so that its layer is 0.
        if (const MtlMap* first = firstOf("map_kd", "map_d")) to_.places.push_back(placeOf(*first));
    }

    GltfMaterial make(bool coloredVertices) {
        setColor(coloredVertices);
        setGloss();
        setNormals();
        const MtlMap* map = from_.map("map_ke");
        to_.material.finish.emission = beside(map, from_.emission, Rgb(0.0f));
        if (map && to_.material.finish.emission != Rgb(0.0f))
            to_.material.finish.emissionTexture =
                slot(pictures_.color(library_, map, nullptr), *map);
        return std::move(to_);
    }

private:
    const MtlMap* firstOf(const char* first, const char* second) const {
        const MtlMap* map = from_.map(first);
        return map ? map : from_.map(second);
    }

    /// Of two pictures that become one: where the first lies, the second does.
    void requireSamePlace(const char* first, const char* second) {
        const MtlMap *a = from_.map(first), *b = from_.map(second);
        if (a && b && placeOf(*a) != placeOf(*b))
            to_.leftOut.push_back(std::string(second) + " -s, -o other than those of " + first);
    }

    TextureSlot slot(int texture, const MtlMap& map) {
        if (texture < 0) return {};
        const GltfTexturePlace place = placeOf(map);
        const auto found = std::ranges::find(to_.places, place);
        const auto layer = static_cast<int>(found - to_.places.begin());
        if (found == to_.places.end()) to_.places.push_back(place);
        return {texture, layer};
    }

    void setColor(bool coloredVertices) {
        Material& to = to_.material;
        const MtlMap *color = from_.map("map_kd"), *opacity = from_.map("map_d");
        requireSamePlace("map_kd", "map_d");
        to.texture = pictures_.color(library_, color, opacity);
        const Rgb one(1.0f);
        const Rgb albedo = coloredVertices ? one : beside(color, from_.diffuse, one);
        for (int k = 0; k < 3; ++k) {
            to.albedo[k] = std::min(albedo[k], 1.0f);
            to_.clamped = to_.clamped || albedo[k] > 1;
        }
        to.opacity = from_.opacity.value_or(1.0f);
        to.blends = to.opacity < 1 || (to.texture >= 0 && pictures_.isTransparent(to.texture));
    }

    void setGloss() {
        const MtlMap *rough = from_.map("map_pr"), *metal = from_.map("map_pm");
        const bool physical = from_.roughness || from_.metallic || rough || metal;
        const Rgb specular = from_.specular.value_or(Rgb(0.0f));
        if (!physical && (from_.illumination < 2 || specular == Rgb(0.0f))) return;
        requireSamePlace("map_pr", "map_pm");
        Gloss gloss;
        const float exponent = std::min(from_.exponent.value_or(0.0f), kMirrorExponent);
        const float byExponent = rough ? 1.0f : 1 - std::sqrt(exponent / kMirrorExponent);
        gloss.roughness = from_.roughness.value_or(byExponent);
        gloss.metallic = from_.metallic.value_or(metal ? 1.0f : 0.0f);
        if (from_.specular) {
            for (int k = 0; k < 3; ++k)
                gloss.specularColor[k] =
                    std::min(specular[k] * kSpecularReflectance, 1.0f) / kDielectricReflectance;
            gloss.specular = specular == Rgb(0.0f) ? 0.0f : 1.0f;
        }
        to_.material.finish.gloss = gloss;
        if (const MtlMap* first = rough ? rough : metal)
            to_.material.finish.metallicRoughness =
                slot(pictures_.roughnessAndMetal(library_, rough, metal), *first);
    }

    /// As glTF has them: green points to the picture's upper edge.
    void setNormals() {
        const MtlMap* map = from_.map("norm");
        if (!map) return;
        to_.material.normal = slot(pictures_.color(library_, map, nullptr), *map);
        to_.material.normalScale = map->strength;
    }

    const MtlMaterial& from_;
    const std::filesystem::path& library_;
    ObjPictures& pictures_;
    GltfMaterial to_;
};

}  // namespace

GltfMaterial objMaterial(const MtlMaterial& from, const std::filesystem::path& library,
                         bool coloredVertices, ObjPictures& pictures) {
    return Maker(from, library, pictures).make(coloredVertices);
}

}  // namespace shadowcache
