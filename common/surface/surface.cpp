#include "common/surface/surface.h"

#include <algorithm>
#include <cmath>

#include "common/surface/microfacet.h"

namespace shadowcache {

namespace {

/// Mean of schlickWeight(o . h) over directions to the light, weighted by the cosine, for a viewer
/// at `cosine` to the normal. The weight depends on o . i alone, so that the mean is a sum of
/// Legendre polynomials of `cosine`; those of degree 0 to 2 are all but 0.004. The rest belongs to
/// the glossy part, which makes up for it exactly.
float meanSchlickWeight(float cosine) noexcept {
    cosine = std::clamp(cosine, 0.0f, 1.0f);
    return 1.0f / 21 - 5.0f / 63 * cosine + 65.0f / 3696 * (3 * cosine * cosine - 1);
}

/// `normal`, turned toward the viewer as far as it must be to face the viewer.
Vec3f facing(const Vec3f& normal, const Vec3f& toViewer) noexcept {
    const float cosine = normal.dot(toViewer);
    if (cosine >= GlossyLobe::kLeastCosine) return normal;
    const Vec3f along = normal - toViewer * cosine;
    const float length = along.length();
    if (!(length > 0)) return toViewer;
    const float sine = std::sqrt(1 - GlossyLobe::kLeastCosine * GlossyLobe::kLeastCosine);
    return (along * (sine / length) + toViewer * GlossyLobe::kLeastCosine).normalized();
}

}  // namespace

Surface lambertian(const Rgb& albedo) noexcept {
    Surface surface;
    surface.baseColor = surface.diffuse = albedo;
    return surface;
}

Surface glossy(const Rgb& baseColor, const Gloss& gloss) noexcept {
    Surface surface;
    surface.baseColor = baseColor;
    surface.roughness = gloss.roughness;
    const float bend = (gloss.ior - 1) / (gloss.ior + 1);
    const float dielectric = 1 - gloss.metallic;
    for (int k = 0; k < 3; ++k) {
        const float f0 = std::min(1.0f, bend * bend * gloss.specularColor[k]) * gloss.specular;
        surface.loss0 = std::max(surface.loss0, f0);
        surface.f0[k] = dielectric * f0 + gloss.metallic * baseColor[k];
        surface.f90[k] = dielectric * gloss.specular + gloss.metallic;
    }
    surface.loss90 = gloss.specular;
    // Without reflection it is Lambertian, and costs no more.
    surface.glossy = surface.f0 != Rgb(0.0f) || surface.f90 != Rgb(0.0f);
    surface.diffuse = baseColor * dielectric;
    return surface;
}

void transmit(float share, Surface& surface) noexcept {
    surface.transmitted = surface.diffuse * share;
    surface.diffuse *= 1 - share;
}

float mirroredShare(const Surface& surface, float cosine) noexcept {
    return surface.loss0 + (surface.loss90 - surface.loss0) * schlickWeight(cosine);
}

Surface scaled(const Surface& surface, const Rgb& factor) noexcept {
    Surface result = surface;
    for (Rgb* part : {&result.baseColor, &result.diffuse, &result.transmitted, &result.f0,
                      &result.f90, &result.emission})
        *part *= factor;
    return result;
}

Rgb diffuseAlbedo(const Surface& surface, float cosine) noexcept {
    if (!surface.glossy) return surface.diffuse;
    const float loss = surface.loss0 + (surface.loss90 - surface.loss0) * meanSchlickWeight(cosine);
    return surface.diffuse * (1 - loss);
}

Rgb reflectance(const Surface& surface, float cosine) noexcept {
    const Rgb mirrors =
        surface.f0 + (surface.f90 - surface.f0) * schlickWeight(std::max(cosine, 0.0f));
    return diffuseAlbedo(surface, cosine) + mirrors;
}

GlossyLobe::GlossyLobe(const Surface& surface, const Vec3f& normal, const Vec3f& toViewer) noexcept
    : n_(facing(normal, toViewer)),
      f0_(surface.f0),
      f90_(surface.f90),
      loss_(surface.diffuse * ((surface.loss90 - surface.loss0) / static_cast<float>(kPi))) {
    const float roughness = std::max(kLeastRoughness, surface.roughness);
    alpha_ = roughness * roughness;
    tangentFrame(n_, s_, t_);
    o_ = local(toViewer);
    meanWeight_ = meanSchlickWeight(normal.dot(toViewer));
}

GlossyLobe GlossyLobe::seenFrom(const Vec3f& normal, const Vec3f& toViewer) const noexcept {
    GlossyLobe lobe = *this;
    lobe.n_ = facing(normal, toViewer);
    tangentFrame(lobe.n_, lobe.s_, lobe.t_);
    lobe.o_ = lobe.local(toViewer);
    return lobe;
}

Rgb GlossyLobe::value(const Vec3f& toLight) const noexcept {
    const Vec3f i = local(toLight);
    if (!(i.z > 0)) return Rgb(0.0f);
    const Vec3f h = (o_ + i).normalized();
    const float weight = schlickWeight(o_.dot(h));
    const float mirrors = ggxDistribution(h, alpha_) * ggxVisibility(o_, i, alpha_);
    return ((f0_ + (f90_ - f0_) * weight) * mirrors + loss_ * (meanWeight_ - weight)) * i.z;
}

void GlossyLobe::values(const float (&toLight)[3][kLanes],
                        float (&values)[3][kLanes]) const noexcept {
    const auto& w = toLight;
    const float distribution = 1 / (static_cast<float>(kPi) * alpha_ * alpha_);
    const float perAlpha = 1 / alpha_, alpha2 = alpha_ * alpha_;
    const float ofViewer = ggxStretch(o_, alpha_);
    alignas(64) float mirrors[kLanes], base[kLanes], weight[kLanes];
    for (int k = 0; k < kLanes; ++k) {
        const float x = w[0][k] * s_.x + w[1][k] * s_.y + w[2][k] * s_.z;
        const float y = w[0][k] * t_.x + w[1][k] * t_.y + w[2][k] * t_.z;
        const float z = w[0][k] * n_.x + w[1][k] * n_.y + w[2][k] * n_.z;
        const float above = z > 0 ? z : 0.0f;
        const float hx = o_.x + x, hy = o_.y + y, hz = o_.z + z;
        const float length2 = hx * hx + hy * hy + hz * hz;
        const float scale2 = 1 / (length2 > 1e-12f ? length2 : 1e-12f);
        const float cosine = std::sqrt(scale2) * std::abs(o_.x * hx + o_.y * hy + o_.z * hz);
        const float rest = cosine < 1 ? 1 - cosine : 0.0f;
        const float square = rest * rest;
        weight[k] = square * square * rest;
        const float sx = hx * perAlpha, sy = hy * perAlpha;
        const float stretched = (sx * sx + sy * sy + hz * hz) * scale2;
        const float ofLight = std::sqrt(alpha2 * (x * x + y * y) + z * z);
        mirrors[k] = above * distribution * 0.5f /
                     (stretched * stretched * (o_.z * ofLight + above * ofViewer));
        base[k] = above * (meanWeight_ - weight[k]);
    }
    for (int c = 0; c < 3; ++c) {
        const float f0 = f0_[c], rise = f90_[c] - f0_[c], loss = loss_[c];
        for (int k = 0; k < kLanes; ++k)
            values[c][k] = (f0 + rise * weight[k]) * mirrors[k] + loss * base[k];
    }
}

Vec3f GlossyLobe::mirrored() const noexcept {
    return s_ * -o_.x + t_ * -o_.y + n_ * o_.z;
}

float GlossyLobe::density(const Vec3f& toLight) const noexcept {
    const Vec3f half = o_ + local(toLight);
    const float length = half.length();
    if (!(half.z > 0) || !(length > 0)) return 0;
    return visibleNormalDensity(o_, half / length, alpha_);
}

Vec3f GlossyLobe::sample(float u, float v) const noexcept {
    const Vec3f h = sampleVisibleNormal(o_, alpha_, u, v);
    const Vec3f i = h * (2 * o_.dot(h)) - o_;
    return (s_ * i.x + t_ * i.y + n_ * i.z).normalized();
}

}  // namespace shadowcache
