#include "common/import/texture_decoder.h"

#include <cstdlib>
#include <limits>
#include <memory>

#ifndef __clang_analyzer__  // which finds what is not ours to mend
#define STB_IMAGE_IMPLEMENTATION
#endif
#define STB_IMAGE_STATIC
#define STBI_ONLY_JPEG
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#include <stb/stb_image.h>

namespace shadowcache {

Texture decodeTexture(std::string_view bytes, std::string& cause) {
    Texture texture;
    if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        cause = "larger than 2 GB";
        return texture;
    }
    int channels = 0;
    const std::unique_ptr<stbi_uc, decltype(&std::free)> texels(
        stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                              static_cast<int>(bytes.size()), &texture.width, &texture.height,
                              &channels, 4),
        &std::free);
    if (!texels) {
        cause = stbi_failure_reason();
        return {};
    }
    texture.rgba.assign(texels.get(), texels.get() + 4 * static_cast<std::size_t>(texture.width) *
                                                         static_cast<std::size_t>(texture.height));
    return texture;
}

}  // namespace shadowcache
