#pragma once

#include <cmath>

namespace shadowcache {

/// Linear value of an sRGB-encoded one, both in [0, 1]. [IEC 61966-2-1]
inline float srgbToLinear(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

/// The inverse of srgbToLinear.
inline float linearToSrgb(float linear) {
    return linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

}  // namespace shadowcache
