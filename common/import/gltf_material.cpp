#include "common/import/gltf_material.h"

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <fmt/core.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/error.h"
#include "common/import/gltf_extensions.h"

namespace shadowcache {

namespace {

/// More light than that has no meaning, and its square no room.
constexpr double kMostEmission = 1e15;

class MaterialReader {
public:
    MaterialReader(const std::filesystem::path& path, const tinygltf::Material& from,
                   std::size_t textures)
        : path_(path), from_(from), textures_(textures) {}

    GltfMaterial read() {
        readAlpha();
        const auto extension = [&](const char* name) {
            const auto found = from_.extensions.find(name);
            return found == from_.extensions.end() ? nullptr : &found->second;
        };
        finish_.unlit = extension("KHR_materials_unlit") != nullptr;
        if (const auto* older = extension("KHR_materials_pbrSpecularGlossiness")) {
            readSpecularGlossiness(*older);
        } else {
            readBaseColor();
            readGloss();
            if (const auto* ior = extension("KHR_materials_ior")) readIor(*ior);
            if (const auto* specular = extension("KHR_materials_specular")) readSpecular(*specular);
        }
        readNormalMap();
        readEmission(extension("KHR_materials_emissive_strength"));
        for (const auto& [name, value] : from_.extensions)
            if (!isReadOfMaterials(name) && name.find("_materials_") != std::string::npos)
                to_.leftOut.push_back(name);
        return std::move(to_);
    }

private:
    [[noreturn]] void fail(const std::string& cause) const {
        throwFileError(path_, "material " + from_.name + ": " + cause);
    }

    float bounded(double x, double least, double most) {
        const double within = std::isfinite(x) ? std::clamp(x, least, most) : least;
        to_.clamped = to_.clamped || within != x;
        return static_cast<float>(within);
    }
    float share(double x) { return bounded(x, 0, 1); }

    static double numberOf(const tinygltf::Value& value, const char* name, double fallback) {
        return value.Has(name) && value.Get(name).IsNumber() ? value.Get(name).GetNumberAsDouble()
                                                             : fallback;
    }

    /// A pair of KHR_texture_transform.
    static std::array<double, 2> pairOf(const tinygltf::Value& value, const char* name,
                                        double fallback) {
        const tinygltf::Value& list = value.Get(name);
        if (list.ArrayLen() < 2) return {fallback, fallback};
        return {list.Get(0).GetNumberAsDouble(), list.Get(1).GetNumberAsDouble()};
    }

    static GltfTexturePlace placeOf(int texcoordSet, const tinygltf::Value& transform) {
        GltfTexturePlace place{texcoordSet};
        const auto offset = pairOf(transform, "offset", 0), scale = pairOf(transform, "scale", 1);
        const double angle = numberOf(transform, "rotation", 0);
        place.texcoordSet =
            static_cast<int>(numberOf(transform, "texCoord", static_cast<double>(texcoordSet)));
        // Counter-clockwise in the picture, whose t points down.
        const double c = std::cos(angle), s = std::sin(angle);
        place.toS = Vec3f(Vec3d(c * scale[0], s * scale[1], offset[0]));
        place.toT = Vec3f(Vec3d(-s * scale[0], c * scale[1], offset[1]));
        return place;
    }

    TextureSlot slot(int texture, int texcoordSet, const tinygltf::Value* transform) {
        if (texture < 0 || static_cast<std::size_t>(texture) >= textures_)
            fail(fmt::format("texture {}{}", texture,
                             textures_ == 0 ? ", but the file has none"
                                            : fmt::format(", expected 0 to {}", textures_ - 1)));
        const GltfTexturePlace place =
            transform ? placeOf(texcoordSet, *transform) : GltfTexturePlace{texcoordSet};
        const Vec3f sum = place.toS + place.toT;
        if (!std::isfinite(sum.x + sum.y + sum.z)) fail("KHR_texture_transform is not finite");
        const auto found = std::ranges::find(to_.places, place);
        const auto layer = static_cast<int>(found - to_.places.begin());
        if (found == to_.places.end()) to_.places.push_back(place);
        return {texture, layer};
    }

    /// Of tinygltf's own structures.
    template <class Info>
    TextureSlot slotOf(const Info& info) {
        if (info.index < 0) return {};
        const auto found = info.extensions.find("KHR_texture_transform");
        return slot(info.index, info.texCoord,
                    found == info.extensions.end() ? nullptr : &found->second);
    }

    /// Of an extension's JSON.
    TextureSlot slotOf(const tinygltf::Value& extension, const char* name) {
        if (!extension.Has(name)) return {};
        const tinygltf::Value& info = extension.Get(name);
        const tinygltf::Value& extensions = info.Get("extensions");
        const bool transformed = extensions.Has("KHR_texture_transform");
        return slot(static_cast<int>(numberOf(info, "index", -1)),
                    static_cast<int>(numberOf(info, "texCoord", 0)),
                    transformed ? &extensions.Get("KHR_texture_transform") : nullptr);
    }

    void readBaseColor() {
        const auto& factor = from_.pbrMetallicRoughness.baseColorFactor;
        if (factor.size() != 4)
            fail(fmt::format("baseColorFactor of {} numbers, expected 4", factor.size()));
        Material& to = to_.material;
        to.albedo = Rgb(share(factor[0]), share(factor[1]), share(factor[2]));
        to.opacity = share(factor[3]);
        // The first, so that its layer is 0.
        to.texture = slotOf(from_.pbrMetallicRoughness.baseColorTexture).texture;
    }

    void readAlpha() {
        Material& to = to_.material;
        to.cutoff = static_cast<float>(from_.alphaCutoff);
        to.cutOut = from_.alphaMode == "MASK";
        to.doubleSided = from_.doubleSided;
        to.blends = from_.alphaMode == "BLEND";
    }

    /// A list of numbers of an extension's JSON; all are 1 where there is no list of that length.
    static std::vector<double> factorsOf(const tinygltf::Value& extension, const char* name,
                                         std::size_t count) {
        std::vector<double> factors(count, 1.0);
        const tinygltf::Value& list = extension.Get(name);
        for (std::size_t k = 0; k < count && list.ArrayLen() == count; ++k)
            factors[k] = list.Get(static_cast<int>(k)).GetNumberAsDouble();
        return factors;
    }

    /// What KHR_materials_pbrSpecularGlossiness states in place of metalness and roughness. With
    /// index 0, a dielectric reflects its specular colour head-on [KHR_materials_ior].
    void readSpecularGlossiness(const tinygltf::Value& extension) {
        const auto diffuse = factorsOf(extension, "diffuseFactor", 4);
        Material& to = to_.material;
        to.albedo = Rgb(share(diffuse[0]), share(diffuse[1]), share(diffuse[2]));
        to.opacity = share(diffuse[3]);
        // The first, so that its layer is 0.
        to.texture = slotOf(extension, "diffuseTexture").texture;
        const float glossiness = share(numberOf(extension, "glossinessFactor", 1));
        finish_.gloss = Gloss{0, 1 - glossiness};
        Gloss& gloss = *finish_.gloss;
        gloss.ior = 0;
        const auto specular = factorsOf(extension, "specularFactor", 3);
        for (int k = 0; k < 3; ++k)
            gloss.specularColor[k] = share(specular[static_cast<std::size_t>(k)]);
        finish_.specularColor = slotOf(extension, "specularGlossinessTexture");
        if (finish_.specularColor.texture < 0) return;
        finish_.metallicRoughness = finish_.specularColor;
        to_.glossiness = glossiness;
        gloss.roughness = 1;
    }

    void readGloss() {
        const auto& pbr = from_.pbrMetallicRoughness;
        finish_.gloss = Gloss{share(pbr.metallicFactor), share(pbr.roughnessFactor)};
        finish_.metallicRoughness = slotOf(pbr.metallicRoughnessTexture);
    }

    void readIor(const tinygltf::Value& extension) {
        const double ior = numberOf(extension, "ior", 1.5);
        finish_.gloss->ior = ior == 0 ? 0.0f : bounded(ior, 1, 1e6);
    }

    void readSpecular(const tinygltf::Value& extension) {
        Gloss& gloss = *finish_.gloss;
        gloss.specular = share(numberOf(extension, "specularFactor", 1));
        if (const tinygltf::Value& color = extension.Get("specularColorFactor");
            color.ArrayLen() == 3)
            for (int k = 0; k < 3; ++k)
                gloss.specularColor[k] = bounded(color.Get(k).GetNumberAsDouble(), 0, 1e6);
        finish_.specular = slotOf(extension, "specularTexture");
        finish_.specularColor = slotOf(extension, "specularColorTexture");
    }

    void readNormalMap() {
        to_.material.normal = slotOf(from_.normalTexture);
        const double scale = from_.normalTexture.scale;
        to_.material.normalScale = static_cast<float>(std::isfinite(scale) ? scale : 1);
    }

    void readEmission(const tinygltf::Value* strength) {
        const auto& factor = from_.emissiveFactor;
        if (factor.size() != 3) return;
        const double scale = strength ? numberOf(*strength, "emissiveStrength", 1) : 1;
        for (int k = 0; k < 3; ++k)
            finish_.emission[k] =
                bounded(factor[static_cast<std::size_t>(k)] * scale, 0, kMostEmission);
        if (finish_.emission != Rgb(0.0f)) finish_.emissionTexture = slotOf(from_.emissiveTexture);
    }

    const std::filesystem::path& path_;
    const tinygltf::Material& from_;
    const std::size_t textures_;
    GltfMaterial to_;
    Finish& finish_ = to_.material.finish;
};

}  // namespace

GltfMaterial gltfMaterial(const std::filesystem::path& path, const tinygltf::Material& from,
                          std::size_t textures) {
    return MaterialReader(path, from, textures).read();
}

}  // namespace shadowcache
