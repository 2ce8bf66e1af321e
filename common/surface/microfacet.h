#pragma once

#include <algorithm>
#include <cmath>

#include "common/math/vec.h"

namespace shadowcache {

// A surface of microscopic mirrors whose normals follow the GGX distribution, with the
// height-correlated masking and shadowing of Smith. All vectors are of unit length, in a space
// whose z axis is the surface's normal; `alpha`, 0 to 1, above 0, is the square of glTF's
// roughness; directions point away from the surface, to the viewer (o) and to the light (i), with
// z above 0. [Walter et al. 2007; Heitz 2014; glTF 2.0, Appendix B]

/// Density of the normals h of the mirrors: the integral of it times h.z over the hemisphere is 1.
/// [1/sr]
inline float ggxDistribution(const Vec3f& h, float alpha) noexcept {
    // tan^2 / alpha^2 + 1, times cos^2; from the sine, because 1 - cos^2 has no digits near 0.
    const float x = h.x / alpha, y = h.y / alpha;
    const float stretched = x * x + y * y + h.z * h.z;
    return 1 / (static_cast<float>(kPi) * alpha * alpha * stretched * stretched);
}

/// cos sqrt(1 + alpha^2 tan^2), which masking and shadowing are made of.
inline float ggxStretch(const Vec3f& w, float alpha) noexcept {
    return std::sqrt(alpha * alpha * (w.x * w.x + w.y * w.y) + w.z * w.z);
}

/// Masking and shadowing over 4 o.z i.z: the reflected share of light is this times the
/// distribution, the Fresnel reflectance and the cosine i.z.
inline float ggxVisibility(const Vec3f& o, const Vec3f& i, float alpha) noexcept {
    return 0.5f / (o.z * ggxStretch(i, alpha) + i.z * ggxStretch(o, alpha));
}

/// Normal of a mirror that the viewer sees, distributed as the visible area.
///
/// @param u, v  in [0, 1)
///
/// Source: Dupuy & Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps".
inline Vec3f sampleVisibleNormal(const Vec3f& o, float alpha, float u, float v) noexcept {
    const Vec3f stretched = Vec3f(alpha * o.x, alpha * o.y, o.z).normalized();
    // A direction on the cap of the sphere that the viewer's hemisphere reflects to, and half-way.
    const float up = (1 - v) * (1 + stretched.z);
    const float z = up - stretched.z;
    const float sine = std::sqrt(std::max(0.0f, 1 - z * z));
    const float phi = 2 * static_cast<float>(kPi) * u;
    const Vec3f half(sine * std::cos(phi) + stretched.x, sine * std::sin(phi) + stretched.y, up);
    return Vec3f(alpha * half.x, alpha * half.y, half.z).normalized();
}

/// Density of the directions in which those mirrors, with normal h, reflect the viewer. [1/sr]
inline float visibleNormalDensity(const Vec3f& o, const Vec3f& h, float alpha) noexcept {
    return 0.5f * ggxDistribution(h, alpha) / (o.z + ggxStretch(o, alpha));
}

/// Weight of the reflectance at grazing incidence against that at normal incidence, for the cosine
/// between a mirror's normal and a direction. [Schlick 1994]
inline float schlickWeight(float cosine) noexcept {
    const float x = 1 - std::min(1.0f, std::abs(cosine));
    const float square = x * x;
    return square * square * x;
}

}  // namespace shadowcache
