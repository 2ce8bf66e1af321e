#include "common/import/webp_decoder.h"

#include <fmt/core.h>
#include <webp/decode.h>

namespace shadowcache {

bool isWebp(std::string_view bytes) {
    constexpr std::size_t kKind = 8;  // behind RIFF and the length
    return bytes.starts_with("RIFF") && bytes.substr(0, kKind + 4).ends_with("WEBP");
}

Texture decodeWebp(std::string_view bytes, double mostTexels, std::string& cause) {
    const auto* data = reinterpret_cast<const std::uint8_t*>(bytes.data());
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(data, bytes.size(), &features) != VP8_STATUS_OK) {
        cause = "a damaged WebP header";
        return {};
    }
    if (features.has_animation) {
        cause = "an animated WebP, expected one picture";
        return {};
    }
    Texture texture;
    texture.width = features.width;
    texture.height = features.height;
    if (static_cast<double>(texture.width) * static_cast<double>(texture.height) > mostTexels) {
        cause =
            fmt::format("{} x {} pixels in {} bytes", texture.width, texture.height, bytes.size());
        return {};
    }
    texture.rgba.resize(4 * static_cast<std::size_t>(texture.width) *
                        static_cast<std::size_t>(texture.height));
    if (!WebPDecodeRGBAInto(data, bytes.size(), texture.rgba.data(), texture.rgba.size(),
                            4 * texture.width)) {
        cause = "a WebP that is cut short or damaged";
        return {};
    }
    return texture;
}

}  // namespace shadowcache
