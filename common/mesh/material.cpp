#include "common/mesh/material.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/image/srgb.h"

namespace shadowcache {

namespace {

std::array<float, 256> makeLinearTable() {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i)
        table[i] = srgbToLinear(static_cast<float>(i) / 255.0f);
    return table;
}

/// A coordinate with whole periods taken off where its texel would overflow an int; what is not
/// finite is 0.
float tame(float x, Texture::Wrap wrap) {
    constexpr float kFar = 4096;
    if (std::abs(x) < kFar) return x;
    if (!std::isfinite(x)) return 0;
    if (wrap == Texture::Wrap::clamp) return std::copysign(kFar, x);
    const float period = wrap == Texture::Wrap::mirror ? 2.0f : 1.0f;
    return x - period * std::floor(x / period);
}

int wrapped(int i, int size, Texture::Wrap wrap) {
    if (wrap == Texture::Wrap::clamp) return std::clamp(i, 0, size - 1);
    const int period = wrap == Texture::Wrap::mirror ? 2 * size : size;
    const int rest = (i % period + period) % period;
    return rest < size ? rest : period - 1 - rest;
}

/// Four texels around a place and their weights.
struct Footprint {
    std::array<std::size_t, 4> texel;  ///< where they begin in Texture::rgba
    std::array<float, 4> weight;
};

Footprint footprint(const Texture& texture, float s, float t) {
    const float x = tame(s, texture.wrapS) * static_cast<float>(texture.width);
    const float y = tame(t, texture.wrapT) * static_cast<float>(texture.height);
    const float left = texture.smooth ? std::floor(x - 0.5f) : std::floor(x);
    const float top = texture.smooth ? std::floor(y - 0.5f) : std::floor(y);
    const float fx = texture.smooth ? x - 0.5f - left : 0.0f;
    const float fy = texture.smooth ? y - 0.5f - top : 0.0f;
    Footprint result;
    for (int k = 0; k < 4; ++k) {
        const int i = wrapped(static_cast<int>(left) + (k & 1), texture.width, texture.wrapS);
        const int j = wrapped(static_cast<int>(top) + (k >> 1), texture.height, texture.wrapT);
        const auto at = static_cast<std::size_t>(k);
        result.texel[at] =
            4 * (static_cast<std::size_t>(j) * static_cast<std::size_t>(texture.width) +
                 static_cast<std::size_t>(i));
        result.weight[at] = ((k & 1) != 0 ? fx : 1 - fx) * ((k >> 1) != 0 ? fy : 1 - fy);
    }
    return result;
}

/// A channel's value, in steps of 8 bits: 0 to 255.
float channel(const Texture& texture, std::size_t at) {
    const auto high = static_cast<float>(texture.rgba[at]);
    return texture.low.empty() ? high : (high * 256 + static_cast<float>(texture.low[at])) / 257;
}

/// The linear value of one that is sRGB-encoded.
float linear(const Texture& texture, std::size_t at, const std::array<float, 256>& table) {
    if (texture.low.empty()) return table[texture.rgba[at]];
    const float encoded = channel(texture, at);
    const auto step = std::min(static_cast<std::size_t>(encoded), table.size() - 2);
    return table[step] + (encoded - static_cast<float>(step)) * (table[step + 1] - table[step]);
}

}  // namespace

Rgb textureColor(const Texture& texture, float s, float t) noexcept {
    static const std::array<float, 256> kLinear = makeLinearTable();
    const Footprint around = footprint(texture, s, t);
    Rgb color(0.0f);
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t at = around.texel[k];
        color += Rgb(linear(texture, at, kLinear), linear(texture, at + 1, kLinear),
                     linear(texture, at + 2, kLinear)) *
                 around.weight[k];
    }
    return color;
}

std::array<float, 4> textureValue(const Texture& texture, float s, float t) noexcept {
    const Footprint around = footprint(texture, s, t);
    std::array<float, 4> value{};
    for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t c = 0; c < 4; ++c)
            value[c] += channel(texture, around.texel[k] + c) * (around.weight[k] / 255.0f);
    return value;
}

float textureOpacity(const Texture& texture, float s, float t) noexcept {
    const Footprint around = footprint(texture, s, t);
    float sum = 0;
    for (std::size_t k = 0; k < 4; ++k)
        sum += static_cast<float>(texture.rgba[around.texel[k] + 3]) * around.weight[k];
    return sum / 255.0f;
}

}  // namespace shadowcache
