#pragma once

// Private to the cache's .cpp files.

#include <cstdint>
#include <filesystem>

#include "common/cache/cache_header.h"
#include "common/math/vec.h"

namespace shadowcache {

/// Counts of the points of a leaf.
struct CountRows {
    const std::uint8_t* data = nullptr;  ///< the first row
    std::uint32_t step = 0;              ///< from one row to the next; 0: all rows are alike

    /// Counts of point i.
    const std::uint8_t* row(std::size_t i) const { return data + i * step; }
};

/// Rows of base cells or of a block that all hold one count, for leaves whose counts OpenVDB keeps
/// as a single value.
CountRows constantRows(std::uint8_t value);

/// Voxels of a leaf, 8 along each axis.
inline constexpr std::size_t kLeafVoxels = 512;
/// Bytes of a leaf's voxelEnd.
inline constexpr std::uint32_t kVoxelEndBytes = kLeafVoxels * sizeof(std::uint32_t);
/// From a leaf's first voxel to voxel v < kLeafVoxels, in OpenVDB's order.
inline Vec3i voxelInLeaf(std::uint32_t v) {
    return {static_cast<int>(v >> 6), static_cast<int>(v >> 3 & 7), static_cast<int>(v & 7)};
}

/// A leaf's items and blocks as plain arrays, wherever they are kept.
struct LeafView {
    const std::uint32_t* voxelEnd = nullptr;   ///< by voxel, in OpenVDB's order: end of its items
    std::uint32_t items = 0;                   ///< number of items
    std::uint64_t firstItem = 0;               ///< items of the leaves before it
    CountRows n, d;                            ///< by item: counts of its base cells
    const Vec3f* normal = nullptr;             ///< by item: unit mean normal
    const Vec3f* position = nullptr;           ///< by item: from the voxel's centre, in spacings
    const std::int16_t* patch = nullptr;       ///< by item: PatchCode, packed
    const std::int32_t* firstBlock = nullptr;  ///< by item: in blockKeys, blockN and blockD
    const std::int16_t* blockCount = nullptr;  ///< by item: number of blocks from there
    const std::uint16_t* hits = nullptr;       ///< by item, hitsPerItem each: HitCode; may be null
    std::uint32_t hitsPerItem = 0;
    const std::uint16_t* emitters = nullptr;  ///< by item, emittersPerItem each: EmitterCode
    std::uint32_t emittersPerItem = 0;

    std::uint32_t blocks = 0;                 ///< number of blocks; with 0 the rest is null
    const std::int16_t* blockKeys = nullptr;  ///< by block: DirectionTiers::blockKey
    CountRows blockN, blockD;                 ///< by block: counts of its kBlockCells cells
};

/// Refuses a leaf that a reader could not use safely: items outside of its voxels, blocks outside
/// of its items or out of order, patches, regions or hits that do not exist.
///
/// @throws Error naming the file and the cause
void requireSound(const LeafView& leaf, const DirectionTiers& tiers,
                  const std::filesystem::path& path);
/// The same of a leaf's hits alone, if it has some.
void requireSoundHits(const LeafView& leaf, const std::filesystem::path& path);

}  // namespace shadowcache
