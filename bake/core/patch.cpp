#include "bake/core/patch.h"

#include <algorithm>
#include <cmath>

#include "bake/core/depth_layers.h"
#include "common/base/tuned.h"
#include "common/cache/cache_items.h"
#include "common/mesh/placed_mesh.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

// A patch may be subdivided if it is one surface, not a heap of leaves.

/// Least area of a patch that may be subdivided, seen from its side, as a share of its box's side.
SHADOWCACHE_TUNED(double, kLeastCutArea, 0.3);
/// Most area of a patch that may be subdivided, the same way: a triangle may be there twice.
SHADOWCACHE_TUNED(double, kMostCutArea, 2.2);
/// Least length of the mean normal, by area, of a patch that may be subdivided.
SHADOWCACHE_TUNED(double, kLeastCutAgreement, 0.97);

/// Least area of a subpatch, as a share of its box's: less is a sliver on the rim of a surface,
/// which is not like the rest of it.
SHADOWCACHE_TUNED(double, kLeastSubpatch, 0.05);

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

/// @param voxelCenter what positions are relative to
Patch makePatch(const Scene& scene, const Vec3d& voxelCenter, double spacing,
                std::vector<Piece> pieces, const Box& box, const PatchCode& code,
                std::uint64_t seed) {
    Patch patch;
    patch.code = code;
    patch.seed = hashWords(seed, BakeSalt::patch, static_cast<std::uint64_t>(code.packed()));
    patch.box = box;
    patch.pieces = std::move(pieces);
    double total = 0;
    for (const Piece& piece : patch.pieces) total += static_cast<double>(piece.area);
    patch.area = static_cast<float>(total);

    Vec3d sumNormal(0, 0, 0), sumPosition(0, 0, 0);
    std::size_t at = 0;
    double below = 0;  // area of the pieces before `at`
    Polygon polygon;
    std::size_t polygonOf = patch.pieces.size();
    for (int i = 0; i < Patch::kOrigins; ++i) {
        const std::uint64_t h = hashWords(patch.seed, static_cast<std::uint64_t>(i));
        const double x = total * (i + toUnit(h)) / Patch::kOrigins;
        while (at + 1 < patch.pieces.size() &&
               x >= below + static_cast<double>(patch.pieces[at].area))
            below += static_cast<double>(patch.pieces[at++].area);
        const Piece& piece = patch.pieces[at];
        if (polygonOf != at) {
            polygon = clipToBox(scene.mesh(), piece.triangle, box);
            polygonOf = at;
        }
        const Vec3d p = polygon.count < 3
                            ? box.center
                            : samplePolygon(polygon, toUnit(hashWords(h, BakeSalt::originU)),
                                            toUnit(hashWords(h, BakeSalt::originV)));
        const auto k = static_cast<std::size_t>(i);
        patch.originNormal[k] = piece.normal;
        patch.origin[k] = scene.rayOrigin(Vec3f(p), piece.triangle, piece.normal);
        sumNormal += Vec3d(piece.normal);
        sumPosition += p - voxelCenter;
    }
    patch.normal = Vec3f(sumNormal.normalized());
    patch.meanPosition = Vec3f(sumPosition / (Patch::kOrigins * spacing));
    for (const Vec3f& n : patch.originNormal)
        patch.minAgreement = std::min(patch.minAgreement, n.dot(patch.normal));
    return patch;
}

}  // namespace

bool maySubdivide(const Patch& patch, double spacing) {
    const int level = subdivisionsOf(patch.code.subpatch);
    if (level == kMaxSubdivisions) return false;
    const double width = spacing / (1 << level);
    double area = 0;
    Vec3d sum(0, 0, 0);
    for (const Piece& piece : patch.pieces) {
        area += static_cast<double>(piece.area);
        sum += Vec3d(piece.normal) * static_cast<double>(piece.area);
    }
    const double seen = std::abs(sum[patch.code.side / 2]);
    return seen > kLeastCutArea * width * width && seen < kMostCutArea * width * width &&
           sum.length() > kLeastCutAgreement * area;
}

std::vector<Patch> makePatches(const Scene& scene, const VoxelFrame& frame,
                               std::span<const Fragment> fragments, std::uint64_t seed,
                               const SideSet& only) {
    std::array<std::vector<Piece>, kSides> sides;
    for (const Fragment& fragment : fragments) {
        const Vec3f n = scene.normal(fragment.triangle);
        const int front = sideOf(n);
        sides[static_cast<std::size_t>(front)].push_back({fragment.triangle, fragment.area, n});
        // What no camera sees needs no items.
        if (!isDoubleSided(scene.mesh(), fragment.triangle)) continue;
        sides[static_cast<std::size_t>(front ^ 1)].push_back(
            {fragment.triangle, fragment.area, -n});
    }
    const std::uint64_t key = fragments[0].voxelKey;
    const Box voxel = frame.box(frame.voxel(key));
    std::vector<Patch> patches;
    for (int side = 0; side < kSides; ++side) {
        const auto& pieces = sides[static_cast<std::size_t>(side)];
        if (pieces.empty() || !only[static_cast<std::size_t>(side)]) continue;
        auto layers = splitDepthLayers(scene.mesh(), voxel, pieces);
        for (std::size_t k = 0; k < layers.size(); ++k) {
            const PatchCode code{side, static_cast<int>(k), 0};
            patches.push_back(makePatch(scene, voxel.center, frame.spacing(), std::move(layers[k]),
                                        voxel, code, hashWords(seed, key)));
        }
    }
    return patches;
}

std::vector<Patch> makeSubpatches(const Scene& scene, const Vec3d& voxelCenter, double spacing,
                                  const Patch& patch) {
    std::vector<Patch> subpatches;
    if (!maySubdivide(patch, spacing)) return subpatches;
    for (int q = 0; q < 4; ++q) {
        PatchCode code = patch.code;
        code.subpatch = subpatchOf(code.subpatch, q);
        Box box = patch.box;
        for (int k = 0; k < 2; ++k) {
            const int along = (patch.code.side / 2 + 1 + k) % 3;
            box.half[along] /= 2;
            box.center[along] += (q >> k & 1 ? 1 : -1) * box.half[along];
        }
        std::vector<Piece> pieces;
        double area = 0;
        for (Piece piece : patch.pieces) {
            const Polygon polygon = clipToBox(scene.mesh(), piece.triangle, box);
            piece.area = polygon.count >= 3 ? static_cast<float>(shadowcache::area(polygon)) : 0.0f;
            if (piece.area > 0) pieces.push_back(piece);
            area += static_cast<double>(piece.area);
        }
        const double width = 2 * box.half[(patch.code.side / 2 + 1) % 3];
        if (area > kLeastSubpatch * width * width)
            subpatches.push_back(
                makePatch(scene, voxelCenter, spacing, std::move(pieces), box, code, patch.seed));
    }
    return subpatches;
}

}  // namespace shadowcache
