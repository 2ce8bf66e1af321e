#include "common/mesh/mesh_fingerprint.h"

#include <array>
#include <bit>

#include "common/base/hash.h"
#include "common/base/parallel.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

constexpr std::size_t kTrianglesPerChunk = 1 << 16;

std::uint64_t hashPosition(const Vec3f& p) {
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value + 0.0f); };
    return hashWords(bits(p.x), bits(p.y), bits(p.z));
}

/// Starts with the corner of the least hash, so that a rotation of the corners changes nothing.
std::uint64_t hashTriangle(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    if (b < a && b <= c) return hashWords(b, c, a);
    if (c < a && c < b) return hashWords(c, a, b);
    return hashWords(a, b, c);
}

std::uint64_t hashFloat(float value) {
    return std::bit_cast<std::uint32_t>(value + 0.0f);
}

/// In place of the cutoff of a material that blends; no cutoff is below 0.
constexpr float kBlends = -1;

std::uint64_t hashSampling(const Texture& texture) {
    return static_cast<std::uint64_t>(texture.wrapS) * 8 +
           static_cast<std::uint64_t>(texture.wrapT) * 2 + (texture.smooth ? 1 : 0);
}

/// Of what decides where a material has holes; 0 if it has none.
std::uint64_t hashCutOut(const TriangleMesh& mesh, const Material& material) {
    if (!material.cutOut && !material.blends) return 0;
    const float cutoff = material.blends ? kBlends : material.cutoff;
    std::uint64_t hash = hashWords(hashFloat(material.opacity), hashFloat(cutoff));
    if (material.texture < 0) return hash;
    const Texture& texture = mesh.textures[static_cast<std::size_t>(material.texture)];
    hash = hashWords(hash, static_cast<std::uint64_t>(texture.width), hashSampling(texture));
    for (std::size_t i = 3; i < texture.rgba.size(); i += 4)
        hash = hashWords(hash, texture.rgba[i]);
    return hash;
}

std::uint64_t hashColor(const Rgb& c) {
    return hashWords(hashFloat(c.x), hashFloat(c.y), hashFloat(c.z));
}

std::uint64_t hashSlot(const TriangleMesh& mesh, const TextureSlot& slot) {
    if (slot.texture < 0) return 0;
    const Texture& texture = mesh.textures[static_cast<std::size_t>(slot.texture)];
    std::uint64_t hash = hashWords(static_cast<std::uint64_t>(texture.width),
                                   static_cast<std::uint64_t>(slot.layer), hashSampling(texture));
    for (const auto* bytes : {&texture.rgba, &texture.low})
        for (const std::uint8_t byte : *bytes) hash = hashWords(hash, byte);
    return hash;
}

/// Of what decides how much light a pane transmits; 0 if it is none.
std::uint64_t hashPane(const TriangleMesh& mesh, const Material& material) {
    if (!material.isPane()) return 0;
    const Finish& finish = material.finish;
    const Gloss gloss = finish.gloss.value_or(Gloss{.specular = 0});
    std::uint64_t hash = hashWords(hashFloat(finish.transmission), hashColor(material.albedo),
                                   hashColor(gloss.specularColor));
    hash = hashWords(hash, hashFloat(gloss.metallic), hashFloat(gloss.ior));
    hash = hashWords(hash, hashFloat(gloss.specular));
    for (const TextureSlot& slot :
         {TextureSlot{material.texture, 0}, finish.metallicRoughness, finish.specular,
          finish.specularColor, finish.transmissionTexture})
        hash = hashWords(hash, hashSlot(mesh, slot));
    return hash;
}

/// Of what decides which sides of a material are baked, and where rays pass it; 0 for both sides
/// that stop them.
std::uint64_t hashLooks(const TriangleMesh& mesh, const Material& material) {
    std::uint64_t pierced = hashCutOut(mesh, material);
    if (material.isPane()) pierced = hashWords(pierced, hashPane(mesh, material));
    return material.doubleSided ? pierced : mixBits(~pierced);
}

std::uint64_t hashTexcoord(const Vec3f& at) {
    return hashWords(hashFloat(at.x), hashFloat(at.y), hashFloat(at.z));
}

/// Of what a vertex has that decides where rays pass its material, with `hash`, of its position.
std::uint64_t hashVertex(const TriangleMesh& mesh, const Material& material, std::size_t vertex,
                         std::uint64_t hash) {
    if (material.isPierced() && !mesh.texcoords.empty())
        hash = hashWords(hash, hashTexcoord(mesh.texcoords[vertex]));
    if (!material.isPane()) return hash;
    for (const std::vector<Vec2f>& layer : mesh.moreTexcoords)
        if (!layer.empty())
            hash = hashWords(hash, hashFloat(layer[vertex].x), hashFloat(layer[vertex].y));
    if (mesh.colors.empty()) return hash;
    Rgb color = mesh.colors[vertex];
    if (color == kNoColor) color = Rgb(1.0f);
    return hashWords(hash, hashColor(color));
}

/// Of a triangle in the world, by the number that placed_mesh.h gives it.
std::uint64_t hashPlaced(const TriangleMesh& mesh, const std::vector<std::uint64_t>& looks,
                         std::uint32_t number) {
    const auto corners = placedCorners(mesh, number);
    std::array<std::uint64_t, 3> hash;
    for (std::size_t k = 0; k < 3; ++k) hash[k] = hashPosition(Vec3f(corners[k]));
    const PlacedTriangle placed = placedTriangle(mesh, number);
    const Material* material = materialOf(mesh, placed.triangle);
    const std::uint64_t look =
        material ? looks[static_cast<std::size_t>(material - mesh.materials.data())] : 0;
    if (look == 0) return hashTriangle(hash[0], hash[1], hash[2]);
    for (int k = 0; k < 3; ++k) {
        std::uint64_t& corner = hash[static_cast<std::size_t>(k)];
        const auto vertex = static_cast<std::size_t>(mesh.triangles[placed.triangle][k]);
        corner = hashVertex(mesh, *material, vertex, corner);
    }
    // A mirrored triangle has its corners the other way round, as seen from its front.
    const bool mirrored = placed.instance && placed.instance->toWorld.mirrors();
    return hashWords(hashTriangle(hash[0], hash[1], hash[2]), look, mirrored ? 1 : 0);
}

}  // namespace

std::uint64_t fingerprint(const TriangleMesh& mesh) {
    std::vector<std::uint64_t> looks;
    for (const Material& material : mesh.materials) looks.push_back(hashLooks(mesh, material));
    const std::size_t count = placedCount(mesh);
    std::vector<std::uint64_t> sums(count / kTrianglesPerChunk + 1, 0);
    parallelFor(count, kTrianglesPerChunk, [&](const Chunk& chunk) {
        std::uint64_t sum = 0;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i)
            sum += hashPlaced(mesh, looks, static_cast<std::uint32_t>(i));
        sums[chunk.index] = sum;
    });
    std::uint64_t total = 0;
    for (const std::uint64_t sum : sums) total += sum;
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value + 0.0); };
    return hashWords(total, count,
                     hashWords(bits(mesh.origin.x), bits(mesh.origin.y), bits(mesh.origin.z)));
}

}  // namespace shadowcache
