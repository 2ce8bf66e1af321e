#include "bake/core/surface_count.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "bake/core/repeated_triangles.h"
#include "common/base/parallel.h"
#include "common/cache/cache_items.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Sides of the surface in a voxel: bit s stands for side s of PatchCode, and bit 8 + k for
/// triangles whose normal leans to axis k.
struct VoxelMask {
    std::uint64_t key;
    std::uint32_t bits;
};

constexpr std::uint32_t kSideBits = (1u << kSides) - 1;

std::uint32_t bitsOf(const TriangleMesh& mesh, std::uint32_t triangle) {
    const int front = sideOf(placedNormal(mesh, triangle));
    const std::uint32_t axis = 256u << (front / 2);
    return axis | 1u << front | (isDoubleSided(mesh, triangle) ? 1u << (front ^ 1) : 0u);
}

/// Sorts masks by voxel and leaves one of each, which has the bits of all.
void unite(std::vector<VoxelMask>& masks) {
    std::ranges::sort(masks, {}, &VoxelMask::key);
    std::size_t kept = 0;
    for (const VoxelMask& mask : masks) {
        if (kept > 0 && masks[kept - 1].key == mask.key)
            masks[kept - 1].bits |= mask.bits;
        else
            masks[kept++] = mask;
    }
    masks.resize(kept);
}

}  // namespace

SurfaceCount countSurface(const TriangleMesh& mesh, const VoxelFrame& frame) {
    constexpr std::size_t kChunkSize = 4096;
    const std::size_t count = placedCount(mesh);
    std::vector<std::vector<VoxelMask>> parts((count + kChunkSize - 1) / kChunkSize);
    const std::vector<bool> repeated = repeatedTriangles(mesh);
    parallelFor(count, kChunkSize, [&](const Chunk& chunk) {
        std::vector<VoxelMask>& masks = parts[chunk.index];
        std::vector<Fragment> fragments;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            if (i < repeated.size() && repeated[i]) continue;
            const auto triangle = static_cast<std::uint32_t>(i);
            fragments.clear();
            cutTriangle(mesh, frame, triangle, fragments);
            const std::uint32_t bits = bitsOf(mesh, triangle);
            for (const Fragment& fragment : fragments) {
                // Neighbouring triangles are often listed together.
                if (!masks.empty() && masks.back().key == fragment.voxelKey)
                    masks.back().bits |= bits;
                else
                    masks.push_back({fragment.voxelKey, bits});
            }
        }
        unite(masks);
    });
    std::vector<VoxelMask> all;
    for (auto& part : parts) {
        all.insert(all.end(), part.begin(), part.end());
        std::vector<VoxelMask>().swap(part);
    }
    unite(all);
    SurfaceCount sum;
    sum.voxels = all.size();
    for (const VoxelMask& mask : all) {
        sum.sides += static_cast<std::size_t>(std::popcount(mask.bits & kSideBits));
        sum.items += 2 * static_cast<std::size_t>(std::popcount(mask.bits & ~kSideBits));
    }
    return sum;
}

}  // namespace shadowcache
