#pragma once

// Private to the cache's .cpp files.

#include <cstdint>
#include <filesystem>

#include "common/cache/cache_header.h"
#include "common/math/vec.h"

namespace shadowcache {

/// Counts of the points of a leaf: row i begins at data + i * step (step 0: all rows are alike).
struct CountRows {
    const std::uint8_t* data = nullptr;
    std::uint32_t step = 0;

    const std::uint8_t* row(std::size_t i) const { return data + i * step; }
};

/// Rows that all hold one count, for leaves whose counts OpenVDB keeps as a single value.
CountRows constantRows(std::uint8_t value);

inline constexpr std::size_t kLeafVoxels = 512;

/// A leaf's items and blocks as plain arrays, wherever they are kept.
struct LeafView {
    const std::uint32_t* voxelEnd = nullptr;  ///< by voxel: end of its items
    std::uint32_t items = 0;
    std::uint64_t firstItem = 0;  ///< items of the leaves before it
    CountRows n, d;
    const Vec3f* normal = nullptr;
    const Vec3f* position = nullptr;      ///< from the voxel's middle, in spacings
    const std::int16_t* patch = nullptr;  ///< PatchCode, packed
    const std::int32_t* firstBlock = nullptr;
    const std::int16_t* blockCount = nullptr;

    std::uint32_t blocks = 0;  ///< with 0 the rest is not there
    const std::int16_t* blockKeys = nullptr;
    CountRows blockN, blockD;
};

/// Refuses a leaf whose numbers would lead its reader out of its arrays.
///
/// @throws Error naming the file
void requireSound(const LeafView& leaf, const DirectionTiers& tiers,
                  const std::filesystem::path& path);

}  // namespace shadowcache
