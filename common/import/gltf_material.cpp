#include "common/import/gltf_material.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/base/report_failure.h"
#include "common/import/gltf_extensions.h"
#include "common/import/gltf_object.h"

namespace shadowcache {

namespace {

/// More light than that has no meaning, and its square no room.
constexpr double kMostEmission = 1e15;
/// Likewise of indices of refraction and specular colours.
constexpr double kMostFactor = 1e6;

/// Of texture coordinates.
constexpr std::size_t kMostSets = 1 << 16;

constexpr const char* kTransmission = "KHR_materials_transmission";
constexpr const char* kVolume = "KHR_materials_volume";

/// Roughness up to which glass is clear, to the eye.
constexpr float kMostClearRoughness = 0.1f;

enum class Alpha { opaque, mask, blend };
constexpr Named<Alpha> kAlphaModes[] = {
    {"OPAQUE", Alpha::opaque}, {"MASK", Alpha::mask}, {"BLEND", Alpha::blend}};

std::vector<double> numbersOr(const std::vector<double>& found,
                              const std::vector<double>& fallback) {
    return found.empty() ? fallback : found;
}

GltfTexturePlace placeOf(const GltfObject& info) {
    const GltfObject transform = info.extension("KHR_texture_transform");
    GltfTexturePlace place;
    for (const GltfObject& from : {info, transform})
        if (const int set = from.index("texCoord", kMostSets); set >= 0) place.texcoordSet = set;
    const auto offset = numbersOr(transform.numbers("offset", 2), {0, 0}),
               scale = numbersOr(transform.numbers("scale", 2), {1, 1});
    const double angle = transform.number("rotation", 0);
    // Counter-clockwise in the picture, whose t points down.
    const double c = std::cos(angle), s = std::sin(angle);
    place.toS = {c * scale[0], s * scale[1], offset[0]};
    place.toT = {-s * scale[0], c * scale[1], offset[1]};
    const Vec3f sum(place.toS + place.toT);
    if (!std::isfinite(sum.x + sum.y + sum.z)) transform.fail("numbers out of range");
    return place;
}

class MaterialReader {
public:
    MaterialReader(const GltfObject& from, std::size_t textures)
        : from_(from), textures_(textures) {}

    GltfMaterial read() {
        to_.name = from_.name();
        readAlpha();
        finish_.unlit = from_.hasExtension("KHR_materials_unlit");
        if (from_.hasExtension("KHR_materials_pbrSpecularGlossiness")) {
            readSpecularGlossiness(from_.extension("KHR_materials_pbrSpecularGlossiness"));
            if (from_.hasExtension(kTransmission)) to_.leftOut.emplace_back(kTransmission);
        } else {
            const GltfObject pbr = from_.object("pbrMetallicRoughness");
            readBaseColor(pbr.numbers("baseColorFactor", 4), slotOf(pbr, "baseColorTexture"));
            finish_.gloss = Gloss{share(pbr.number("metallicFactor", 1)),
                                  share(pbr.number("roughnessFactor", 1))};
            finish_.metallicRoughness = slotOf(pbr, "metallicRoughnessTexture");
            readSpecular();
            readTransmission(from_.extension(kTransmission));
        }
        to_.material.normal = slotOf(from_, "normalTexture");
        to_.material.normalScale =
            static_cast<float>(from_.object("normalTexture").number("scale", 1));
        readEmission();
        for (const std::string& name : from_.object("extensions").keys())
            if (!isReadOfMaterials(name) && name.find("_materials_") != std::string::npos &&
                !(name == kVolume && to_.material.isPane()))
                to_.leftOut.push_back(name);
        return std::move(to_);
    }

private:
    float bounded(double x, double least, double most) {
        const double within = std::clamp(x, least, most);
        to_.clamped = to_.clamped || within != x;
        return static_cast<float>(within);
    }
    float share(double x) { return bounded(x, 0, 1); }

    /// Of a member that names a texture; one without its number is left out.
    TextureSlot slotOf(const GltfObject& owner, const char* name) {
        if (!owner.has(name)) return {};
        const GltfObject info = owner.object(name);
        const int texture = info.index("index", textures_, "texture");
        if (texture < 0) {
            to_.leftOut.emplace_back(name);
            return {};
        }
        const GltfTexturePlace place = placeOf(info);
        const auto found = std::ranges::find(to_.places, place);
        const auto layer = static_cast<int>(found - to_.places.begin());
        if (found == to_.places.end()) to_.places.push_back(place);
        return {texture, layer};
    }

    void readAlpha() {
        Material& to = to_.material;
        const Alpha mode = from_.choice("alphaMode", kAlphaModes, Alpha::opaque);
        to.cutoff = static_cast<float>(from_.number("alphaCutoff", 0.5));
        to.cutOut = mode == Alpha::mask;
        to.blends = mode == Alpha::blend;
        to.doubleSided = from_.flag("doubleSided", false);
    }

    /// @param slot  the first of all, so that its layer is 0
    void readBaseColor(const std::vector<double>& found, const TextureSlot& slot) {
        const std::vector<double> factor = numbersOr(found, {1, 1, 1, 1});
        Material& to = to_.material;
        to.albedo = Rgb(share(factor[0]), share(factor[1]), share(factor[2]));
        to.opacity = share(factor[3]);
        to.texture = slot.texture;
    }

    Rgb color(const GltfObject& owner, const char* name, double most) {
        const std::vector<double> factor = numbersOr(owner.numbers(name, 3), {1, 1, 1});
        return {bounded(factor[0], 0, most), bounded(factor[1], 0, most),
                bounded(factor[2], 0, most)};
    }

    /// What KHR_materials_pbrSpecularGlossiness states in place of metalness and roughness. With
    /// index 0, a dielectric reflects its specular colour head-on [KHR_materials_ior].
    void readSpecularGlossiness(const GltfObject& extension) {
        readBaseColor(extension.numbers("diffuseFactor", 4), slotOf(extension, "diffuseTexture"));
        const float glossiness = share(extension.number("glossinessFactor", 1));
        finish_.gloss = Gloss{0, 1 - glossiness};
        Gloss& gloss = *finish_.gloss;
        gloss.ior = 0;
        gloss.specularColor = color(extension, "specularFactor", 1);
        finish_.specularColor = slotOf(extension, "specularGlossinessTexture");
        if (finish_.specularColor.texture < 0) return;
        finish_.metallicRoughness = finish_.specularColor;
        to_.glossiness = glossiness;
        gloss.roughness = 1;
    }

    void readSpecular() {
        Gloss& gloss = *finish_.gloss;
        const double ior = from_.extension("KHR_materials_ior").number("ior", 1.5);
        gloss.ior = ior == 0 ? 0.0f : bounded(ior, 1, kMostFactor);
        const GltfObject specular = from_.extension("KHR_materials_specular");
        gloss.specular = share(specular.number("specularFactor", 1));
        gloss.specularColor = color(specular, "specularColorFactor", kMostFactor);
        finish_.specular = slotOf(specular, "specularTexture");
        finish_.specularColor = slotOf(specular, "specularColorTexture");
    }

    /// A pane, whatever shape it has: light passes it straight. Both its sides are seen.
    void readTransmission(const GltfObject& extension) {
        const float factor = share(extension.number("transmissionFactor", 0));
        if (factor == 0 || finish_.unlit) return;
        finish_.transmission = factor;
        finish_.transmissionTexture = slotOf(extension, "transmissionTexture");
        to_.material.doubleSided = true;
        if (finish_.gloss->roughness > kMostClearRoughness)
            to_.leftOut.emplace_back("blur by rough glass (light passes straight)");
        if (from_.hasExtension(kVolume))
            to_.leftOut.emplace_back("volume of glass (rendered as panes)");
    }

    void readEmission() {
        const std::vector<double> factor = numbersOr(from_.numbers("emissiveFactor", 3), {0, 0, 0});
        const GltfObject extension = from_.extension("KHR_materials_emissive_strength");
        const double scale = extension.number("emissiveStrength", 1);
        if (!(scale >= 0 && scale <= kMostEmission))
            extension.refuse("emissiveStrength", fmt::format("0 to {:.4g}", kMostEmission));
        for (int k = 0; k < 3; ++k) {
            const double emitted = factor[static_cast<std::size_t>(k)] * scale;
            if (!(emitted >= 0 && emitted <= kMostEmission))
                from_.refuse("emissiveFactor",
                             fmt::format("three numbers of 0 to {:.4g} times emissiveStrength",
                                         kMostEmission));
            finish_.emission[k] = static_cast<float>(emitted);
        }
        if (finish_.emission != Rgb(0.0f))
            finish_.emissionTexture = slotOf(from_, "emissiveTexture");
    }

    const GltfObject& from_;
    const std::size_t textures_;
    GltfMaterial to_;
    Finish& finish_ = to_.material.finish;
};

}  // namespace

void nameOne(const std::string& kind, const std::string& cause, const std::string& name,
             LeftOutOf& leftOut) {
    constexpr std::size_t kMostBytes = 60;
    std::string named = cause + ": " + oneLine(name.substr(0, kMostBytes));
    if (leftOut.size() >= kMostNamed && !leftOut.contains({kind, named}))
        named = cause + ": others";
    ++leftOut[{kind, named}];
}

void nameIfInvisible(const GltfMaterial& material, LeftOutOf& leftOut) {
    const Material& m = material.material;
    if (m.opacity > 0 || !(m.blends || (m.cutOut && m.cutoff > 0))) return;
    nameOne("material", "opacity is 0, so that nothing of it is seen", material.name, leftOut);
}

GltfMaterial gltfMaterial(const GltfObject& from, std::size_t textures) {
    return MaterialReader(from, textures).read();
}

}  // namespace shadowcache
