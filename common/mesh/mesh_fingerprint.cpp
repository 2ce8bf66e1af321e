#include "common/mesh/mesh_fingerprint.h"

#include <algorithm>
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

/// Of what decides where a material has holes; 0 if it has none.
std::uint64_t hashCutOut(const TriangleMesh& mesh, const Material& material) {
    if (!material.cutOut && !material.blends) return 0;
    const float cutoff = material.blends ? kBlends : material.cutoff;
    std::uint64_t hash = hashWords(hashFloat(material.opacity), hashFloat(cutoff));
    if (material.texture < 0) return hash;
    const Texture& texture = mesh.textures[static_cast<std::size_t>(material.texture)];
    hash = hashWords(hash, static_cast<std::uint64_t>(texture.width),
                     static_cast<std::uint64_t>(texture.wrapS) * 8 +
                         static_cast<std::uint64_t>(texture.wrapT) * 2 + (texture.smooth ? 1 : 0));
    for (std::size_t i = 3; i < texture.rgba.size(); i += 4)
        hash = hashWords(hash, texture.rgba[i]);
    return hash;
}

/// Of a triangle's holes; 0 if it can have none.
std::uint64_t hashHoles(const TriangleMesh& mesh, const std::vector<std::uint64_t>& cutOuts,
                        std::uint32_t triangle) {
    const Material* material = materialOf(mesh, triangle);
    if (!material || !(material->cutOut || material->blends)) return 0;
    std::uint64_t hash = cutOuts[static_cast<std::size_t>(material - mesh.materials.data())];
    if (mesh.texcoords.empty()) return hash;
    for (int k = 0; k < 3; ++k) {
        const Vec3f& at = mesh.texcoords[static_cast<std::size_t>(mesh.triangles[triangle][k])];
        hash += hashWords(hash, hashFloat(at.x), hashWords(hashFloat(at.y), hashFloat(at.z)));
    }
    return hash;
}

}  // namespace

std::uint64_t fingerprint(const TriangleMesh& mesh) {
    std::vector<std::uint64_t> cutOuts;
    for (const Material& material : mesh.materials) cutOuts.push_back(hashCutOut(mesh, material));
    const bool holes = std::any_of(cutOuts.begin(), cutOuts.end(), [](auto h) { return h != 0; });
    const std::size_t count = placedCount(mesh);
    std::vector<std::uint64_t> sums(count / kTrianglesPerChunk + 1, 0);
    parallelFor(count, kTrianglesPerChunk, [&](const Chunk& chunk) {
        std::uint64_t sum = 0;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const auto number = static_cast<std::uint32_t>(i);
            const auto corners = placedCorners(mesh, number);
            const auto corner = [&](std::size_t k) { return hashPosition(Vec3f(corners[k])); };
            sum += hashTriangle(corner(0), corner(1), corner(2));
            if (holes) sum += hashHoles(mesh, cutOuts, placedTriangle(mesh, number).triangle);
        }
        sums[chunk.index] = sum;
    });
    std::uint64_t total = 0;
    for (const std::uint64_t sum : sums) total += sum;
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value + 0.0); };
    return hashWords(total, count,
                     hashWords(bits(mesh.origin.x), bits(mesh.origin.y), bits(mesh.origin.z)));
}

}  // namespace shadowcache
