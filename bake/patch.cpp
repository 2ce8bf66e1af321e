#include "bake/patch.h"

#include <algorithm>
#include <cmath>

#include "bake/layers.h"
#include "common/cache_items.h"
#include "common/placed_mesh.h"
#include "common/sequence.h"

namespace shadowcache {

namespace {

/// Uniform point in a convex polygon.
Vec3d samplePolygon(const Polygon& polygon, double u, double v) {
    std::array<double, 9> sizes{};
    double total = 0;
    const auto fanArea = [&](std::size_t i) {
        return (polygon.corner[i - 1] - polygon.corner[0])
            .cross(polygon.corner[i] - polygon.corner[0])
            .length();
    };
    for (std::size_t i = 2; i < polygon.count; ++i) total += sizes[i] = fanArea(i);
    double x = u * total;
    std::size_t i = 2;
    while (i + 1 < polygon.count && x >= sizes[i]) x -= sizes[i++];
    const double size = sizes[i];
    const double root = std::sqrt(size > 0 ? std::min(1.0, x / size) : 0.5);
    return polygon.corner[0] * (1 - root) + polygon.corner[i - 1] * (root * (1 - v)) +
           polygon.corner[i] * (root * v);
}

Patch makePatch(const Scene& scene, const VoxelFrame& frame, std::span<const Piece> pieces,
                int side, std::uint64_t seed) {
    Patch patch;
    patch.side = side;
    const Vec3d center = frame.center(frame.voxel(pieces[0].fragment->voxelKey));
    double total = 0;
    for (const Piece& piece : pieces) total += static_cast<double>(piece.fragment->area);

    Vec3d sumNormal(0, 0, 0), sumPosition(0, 0, 0);
    std::size_t at = 0;
    double below = 0;  // area of the pieces before `at`
    Polygon polygon;
    std::size_t polygonOf = pieces.size();
    for (int i = 0; i < Patch::kOrigins; ++i) {
        const std::uint64_t h = hashWords(seed, static_cast<std::uint64_t>(i));
        const double x = total * (i + toUnit(h)) / Patch::kOrigins;
        while (at + 1 < pieces.size() &&
               x >= below + static_cast<double>(pieces[at].fragment->area))
            below += static_cast<double>(pieces[at++].fragment->area);
        const std::uint32_t triangle = pieces[at].fragment->triangle;
        if (polygonOf != at) {
            polygon = clipToVoxel(scene.mesh(), triangle, center, frame.spacing() / 2);
            polygonOf = at;
        }
        const Vec3d p = polygon.count >= 3 ? samplePolygon(polygon, toUnit(hashWords(h, 1)),
                                                           toUnit(hashWords(h, 2)))
                                           : Vec3d(center);
        const auto k = static_cast<std::size_t>(i);
        patch.originNormal[k] = pieces[at].normal;
        patch.origin[k] = scene.rayOrigin(Vec3f(p), triangle, pieces[at].normal);
        sumNormal += Vec3d(pieces[at].normal);
        sumPosition += p - center;
    }
    patch.normal = Vec3f(sumNormal.normalized());
    patch.meanPosition = Vec3f(sumPosition / (Patch::kOrigins * frame.spacing()));
    for (const Vec3f& n : patch.originNormal)
        patch.minAgreement = std::min(patch.minAgreement, n.dot(patch.normal));
    return patch;
}

}  // namespace

std::vector<Patch> makePatches(const Scene& scene, const VoxelFrame& frame,
                               std::span<const Fragment> fragments, std::uint64_t seed) {
    std::array<std::vector<Piece>, kSides> sides;
    for (const Fragment& fragment : fragments) {
        const Vec3f n = scene.normal(fragment.triangle);
        const int front = sideOf(n);
        sides[static_cast<std::size_t>(front)].push_back({&fragment, n});
        const Material* material =
            materialOf(scene.mesh(), placedTriangle(scene.mesh(), fragment.triangle).triangle);
        // What no camera sees needs no items.
        if (material && !material->doubleSided) continue;
        sides[static_cast<std::size_t>(front ^ 1)].push_back({&fragment, -n});
    }
    std::vector<Patch> patches;
    const auto add = [&](const std::vector<Piece>& pieces, int side) {
        patches.push_back(
            makePatch(scene, frame, pieces, side,
                      hashWords(seed, fragments[0].voxelKey, static_cast<std::uint64_t>(side))));
    };
    for (int side = 0; side < kSides; ++side) {
        const auto& pieces = sides[static_cast<std::size_t>(side)];
        if (pieces.empty()) continue;
        const auto layers = splitLayers(scene.mesh(), frame, pieces);
        for (std::size_t k = 0; k < layers.size(); ++k)
            add(layers[k], side + kSides * static_cast<int>(k));
    }
    std::sort(patches.begin(), patches.end(),
              [](const Patch& a, const Patch& b) { return a.side < b.side; });
    return patches;
}

}  // namespace shadowcache
