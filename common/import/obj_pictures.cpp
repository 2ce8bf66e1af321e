#include "common/import/obj_pictures.h"

#include <fmt/core.h>

#include <utility>

#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/import/picture_channels.h"
#include "common/import/texture_decoder.h"

namespace shadowcache {

namespace {

namespace fs = std::filesystem;

/// Texels that combinations of pictures may have in any set: 256 MB.
constexpr double kCombinedAlways = 0x1p26;
/// And for each texel of the pictures: one is combined with few others.
constexpr double kMostPerTexel = 8;

double texelsOf(const Texture& texture) {
    return static_cast<double>(texture.width) * static_cast<double>(texture.height);
}

}  // namespace

int ObjPictures::color(const fs::path& library, const MtlMap* color, const MtlMap* opacity) {
    return combined("color", colorWithOpacity, library, color, opacity);
}

int ObjPictures::roughnessAndMetal(const fs::path& library, const MtlMap* roughness,
                                   const MtlMap* metallic) {
    return combined("roughness", greenAndBlue, library, roughness, metallic);
}

int ObjPictures::combined(const std::string& kind, Combine combine, const fs::path& library,
                          const MtlMap* first, const MtlMap* second) {
    std::string key = kind;
    const Texture* a = picture(library, first, key);
    const Texture* b = picture(library, second, key);
    if (!a && !b) return -1;
    const bool clamp = (a ? first : second)->clamp;
    key += clamp ? "\nclamp" : "";
    const auto [place, isNew] = textures_.try_emplace(key, static_cast<int>(mesh_.textures.size()));
    if (!isNew) return place->second;
    Texture texture = combine(a, b);
    texelsMade_ += texelsOf(texture);
    if (texelsMade_ > kCombinedAlways + kMostPerTexel * texelsRead_)
        throwFileError(set_,
                       fmt::format("combines its pictures so often that they become more than {} "
                                   "texels, expected no more of pictures of this size",
                                   static_cast<long long>(texelsMade_)));
    texture.wrapS = texture.wrapT = clamp ? Texture::Wrap::clamp : Texture::Wrap::repeat;
    transparent_.push_back(shadowcache::isTransparent(texture));
    mesh_.textures.push_back(std::move(texture));
    return place->second;
}

const Texture* ObjPictures::picture(const fs::path& library, const MtlMap* map, std::string& key) {
    key += '\n';
    if (!map) return nullptr;
    const std::optional<fs::path> file = namedFile(set_, library, map->file, references_);
    if (!file) {
        ++mesh_.leftOut[map->file + " (no such file)"];
        return nullptr;
    }
    std::error_code ignored;
    const fs::path same = fs::weakly_canonical(*file, ignored);
    const Texture* texture = decoded(same.empty() ? *file : same);
    if (texture->rgba.empty()) {
        ++mesh_.leftOut[map->file + " (no whole PNG, JPEG or WebP)"];
        return nullptr;
    }
    key += same.string();
    return texture;
}

const Texture* ObjPictures::decoded(const fs::path& file) {
    const auto [place, isNew] = pictures_.try_emplace(file);
    if (!isNew) return &place->second;
    const std::string bytes = readFileBytes(file);
    if (!isPicture(bytes)) return &place->second;
    std::string cause;
    place->second = decodeTexture(bytes, cause);
    texelsRead_ += texelsOf(place->second);
    return &place->second;
}

}  // namespace shadowcache
