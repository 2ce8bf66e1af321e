#include "common/mesh/looks.h"

#include <algorithm>
#include <array>

#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Value at barycentric coordinates of what each corner has.
template <class T>
T interpolate(const std::vector<T>& values, const Vec3i& t, float u, float v) {
    const auto at = [&](int corner) { return values[static_cast<std::size_t>(corner)]; };
    return at(t.x) * (1 - u - v) + at(t.y) * u + at(t.z) * v;
}

/// A place on a triangle.
struct Place {
    const TriangleMesh& mesh;
    std::uint32_t triangle;
    float u, v;

    template <class T>
    T of(const std::vector<T>& values) const {
        return interpolate(values, mesh.triangles[triangle], u, v);
    }
    /// Whether its file has colours of vertices.
    bool isColored() const {
        const auto corner = static_cast<std::size_t>(mesh.triangles[triangle][0]);
        return !mesh.colors.empty() && mesh.colors[corner] != kNoColor;
    }
    const Texture& texture(int number) const {
        return mesh.textures[static_cast<std::size_t>(number)];
    }
    /// Texture coordinates of a slot.
    Vec2f in(const TextureSlot& slot) const {
        if (slot.layer == 0) {
            const Vec3f at = of(mesh.texcoords);
            return {at.x, at.y};
        }
        return of(mesh.moreTexcoords[static_cast<std::size_t>(slot.layer - 1)]);
    }
    Rgb color(const TextureSlot& slot) const {
        const Vec2f at = in(slot);
        return textureColor(texture(slot.texture), at.x, at.y);
    }
    std::array<float, 4> value(const TextureSlot& slot) const {
        const Vec2f at = in(slot);
        return textureValue(texture(slot.texture), at.x, at.y);
    }
};

Rgb baseColor(const Place& place, const Material* material, const Rgb& fallback) {
    const TriangleMesh& mesh = place.mesh;
    const bool colored = place.isColored();
    if (!material && !colored) return fallback;
    Rgb albedo = material ? material->albedo : Rgb(1.0f);
    if (colored) albedo *= place.of(mesh.colors);
    if (material && material->texture >= 0) albedo *= place.color({material->texture, 0});
    return albedo;
}

/// The gloss with its textures.
Gloss glossAt(const Place& place, const Finish& finish) {
    Gloss gloss = *finish.gloss;
    if (finish.metallicRoughness.texture >= 0) {
        const std::array<float, 4> value = place.value(finish.metallicRoughness);
        gloss.roughness *= value[1];
        gloss.metallic *= value[2];
    }
    if (finish.specular.texture >= 0) gloss.specular *= place.value(finish.specular)[3];
    if (finish.specularColor.texture >= 0) gloss.specularColor *= place.color(finish.specularColor);
    return gloss;
}

/// Share of the base that transmits.
float transmissionAt(const Place& place, const Finish& finish) {
    if (finish.transmissionTexture.texture < 0) return finish.transmission;
    return finish.transmission * place.value(finish.transmissionTexture)[0];
}

Surface surfaceOf(const Place& place, const Material& material, const Rgb& color) {
    const Finish& finish = material.finish;
    Surface surface;
    if (finish.unlit) {
        surface.unlit = true;
        surface.baseColor = surface.emission = color;
        return surface;
    }
    surface = finish.gloss ? glossy(color, glossAt(place, finish)) : lambertian(color);
    if (material.isPane()) transmit(transmissionAt(place, finish), surface);
    surface.emission = finish.emission * finish.gain;
    if (finish.emissionTexture.texture >= 0)
        surface.emission *= place.color(finish.emissionTexture);
    return surface;
}

}  // namespace

Surface surfaceAt(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v,
                  const PlainLook& plain) noexcept {
    const Place place{mesh, triangle, u, v};
    const Material* material = materialOf(mesh, triangle);
    const Rgb color = baseColor(place, material, plain.albedo);
    if (material) return surfaceOf(place, *material, color);
    return plain.gloss ? glossy(color, *plain.gloss) : lambertian(color);
}

Rgb albedoAt(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v,
             const Rgb& fallback) noexcept {
    return baseColor({mesh, triangle, u, v}, materialOf(mesh, triangle), fallback);
}

std::array<float, 4> textureAt(const TriangleMesh& mesh, std::uint32_t triangle, float u, float v,
                               const TextureSlot& slot) noexcept {
    return Place{mesh, triangle, u, v}.value(slot);
}

std::array<Vec2f, 3> texturePlaces(const TriangleMesh& mesh, std::uint32_t triangle,
                                   int layer) noexcept {
    const auto at = [&](float u, float v) { return Place{mesh, triangle, u, v}.in({-1, layer}); };
    return {at(0, 0), at(1, 0), at(0, 1)};
}

namespace {

/// As the files state it, before a cutoff.
float statedOpacity(const TriangleMesh& mesh, const Material& material, std::uint32_t triangle,
                    float u, float v) noexcept {
    float opacity = material.opacity;
    if (mesh.texcoords.empty()) return opacity;
    const Vec3f at = Place{mesh, triangle, u, v}.of(mesh.texcoords);
    opacity *= at.z;
    if (material.texture >= 0)
        opacity *=
            textureOpacity(mesh.textures[static_cast<std::size_t>(material.texture)], at.x, at.y);
    return opacity;
}

}  // namespace

float opacityAt(const TriangleMesh& mesh, const Material& material, std::uint32_t triangle, float u,
                float v) noexcept {
    if (!material.cutOut && !material.blends) return 1;
    const float opacity = statedOpacity(mesh, material, triangle, u, v);
    if (material.blends) return std::clamp(opacity, 0.0f, 1.0f);
    return opacity < material.cutoff ? 0.0f : 1.0f;
}

Passage passageAt(const TriangleMesh& mesh, const Material& material, std::uint32_t triangle,
                  float u, float v, float cosine) noexcept {
    Passage passage;
    const float covered = opacityAt(mesh, material, triangle, u, v);
    passage.stopped = covered;
    if (!material.isPane() || covered == 0) return passage;
    const Place place{mesh, triangle, u, v};
    const Surface surface = surfaceOf(place, material, baseColor(place, &material, Rgb(0.0f)));
    const Rgb through =
        surface.transmitted * (covered * (1 - mirroredShare(surface, cosine))) + Rgb(1 - covered);
    const float passed = std::clamp(luminance(through), 0.0f, 1.0f);
    passage.stopped = 1 - passed;
    if (passed > 0) passage.tint = through / passed;
    passage.weight = passage.stopped > 0 ? covered / passage.stopped : 0;
    return passage;
}

bool mayTint(const TriangleMesh& mesh, const Material& material) noexcept {
    if (!material.isPane()) return false;
    const Rgb& c = material.albedo;
    return material.texture >= 0 || !mesh.colors.empty() || c.x != c.y || c.y != c.z;
}

}  // namespace shadowcache
