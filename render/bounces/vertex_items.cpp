#include "render/bounces/vertex_items.h"

#include <algorithm>
#include <compare>

#include "common/base/parallel.h"

namespace shadowcache {

namespace {

/// Vertices that a thread takes at a time.
constexpr std::size_t kLookupChunk = 1024;

/// The voxels that are looked up together have this many bits of their coordinates in common.
constexpr int kVoxelBits = 3;

}  // namespace

// Lookups go from place to place of the set, each of which is in the processor's cache then: rays
// that leave together meet places that are far apart.
void findItems(const ItemTable& items, const Vec3d& origin, std::span<const std::uint32_t> numbers,
               std::span<PathVertex> vertices) {
    struct Lookup {
        std::uint64_t place;
        std::uint32_t vertex;
        auto operator<=>(const Lookup&) const = default;
    };
    std::vector<Lookup> lookups(numbers.size());
    const auto positionOf = [&](const PathVertex& v) { return origin + Vec3d(v.target); };
    parallelFor(numbers.size(), kLookupChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            const Vec3d at = positionOf(vertices[numbers[i]]) / items.spacing();
            std::uint64_t place = 0;
            for (int k = 0; k < 3; ++k) {
                // Beyond 2^20 places repeat, which costs time alone.
                const auto voxel = static_cast<std::int64_t>(std::clamp(at[k], -1e15, 1e15));
                place = place << 21 | (static_cast<std::uint64_t>(voxel >> kVoxelBits) & 0x1fffff);
            }
            lookups[i] = {place, numbers[i]};
        }
    });
    std::ranges::sort(lookups);
    parallelFor(lookups.size(), kLookupChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            PathVertex& v = vertices[lookups[i].vertex];
            v.item = items.itemAt(positionOf(v), v.geometricNormal);
        }
    });
}

}  // namespace shadowcache
