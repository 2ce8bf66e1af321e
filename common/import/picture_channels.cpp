#include "common/import/picture_channels.h"

#include <cmath>
#include <cstddef>

namespace shadowcache {

namespace {

std::size_t texelCount(const Texture& texture) {
    return static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height);
}

std::uint8_t byteOf(float share) {
    return static_cast<std::uint8_t>(std::lround(share * 255.0f));
}

float mean(const std::array<float, 4>& value) {
    return (value[0] + value[1] + value[2]) / 3;
}

/// A white picture in the size of the larger of two, of which one may be null.
Texture canvas(const Texture* a, const Texture* b) {
    Texture result;
    for (const Texture* from : {a, b}) {
        if (!from || texelCount(*from) <= texelCount(result)) continue;
        result.width = from->width;
        result.height = from->height;
    }
    result.rgba.assign(4 * texelCount(result), 255);
    return result;
}

/// Calls `set(texel's first byte, value of `from` there)` for each texel of `to`.
template <class Set>
void fill(Texture& to, const Texture& from, const Set& set) {
    for (int y = 0; y < to.height; ++y)
        for (int x = 0; x < to.width; ++x) {
            const std::size_t at =
                4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(to.width) +
                     static_cast<std::size_t>(x));
            const float s = (static_cast<float>(x) + 0.5f) / static_cast<float>(to.width);
            const float t = (static_cast<float>(y) + 0.5f) / static_cast<float>(to.height);
            set(&to.rgba[at], textureValue(from, s, t));
        }
}

}  // namespace

Texture colorWithOpacity(const Texture* color, const Texture* opacity) {
    const bool keeps = color && (!opacity || texelCount(*color) >= texelCount(*opacity));
    Texture result = keeps ? *color : canvas(color, opacity);
    if (color && !keeps)
        fill(result, *color, [](std::uint8_t* texel, const std::array<float, 4>& value) {
            for (std::size_t k = 0; k < 3; ++k) texel[k] = byteOf(value[k]);
        });
    for (std::size_t i = 3; i < result.rgba.size(); i += 4) result.rgba[i] = 255;
    if (!opacity) return result;
    const bool own = isTransparent(*opacity);
    fill(result, *opacity, [&](std::uint8_t* texel, const std::array<float, 4>& value) {
        texel[3] = byteOf(own ? value[3] : mean(value));
    });
    return result;
}

Texture greenAndBlue(const Texture* green, const Texture* blue) {
    Texture result = canvas(green, blue);
    if (green)
        fill(result, *green, [](std::uint8_t* texel, const std::array<float, 4>& value) {
            texel[1] = byteOf(mean(value));
        });
    if (blue)
        fill(result, *blue, [](std::uint8_t* texel, const std::array<float, 4>& value) {
            texel[2] = byteOf(mean(value));
        });
    return result;
}

bool isTransparent(const Texture& texture) {
    for (std::size_t i = 3; i < texture.rgba.size(); i += 4)
        if (texture.rgba[i] != 255) return true;
    return false;
}

}  // namespace shadowcache
