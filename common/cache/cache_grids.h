#pragma once

// Private to the cache's .cpp files: the only ones that see OpenVDB.

#include <openvdb/openvdb.h>
#include <openvdb/points/PointDataGrid.h>

#include <filesystem>

#include "common/cache/cache_items.h"
#include "common/cache/volume_grids.h"

namespace shadowcache {

/// Names in the file (docs/format.md).
inline constexpr const char* kFormatKey = "shadowcache_format";
inline constexpr const char* kItemGrid = "shadowcache_items";
inline constexpr const char* kBlockGrid = "shadowcache_blocks";
inline constexpr const char* kSkyVisibilityGrid = "openness";
inline constexpr const char* kBentNormalGrid = "open_direction";

using PointGrid = openvdb::points::PointDataGrid;
using PointLeaf = openvdb::points::PointDataTree::LeafNodeType;
using ByteArray = openvdb::points::TypedAttributeArray<std::int8_t>;
using ShortArray = openvdb::points::TypedAttributeArray<std::int16_t>;
using IntArray = openvdb::points::TypedAttributeArray<std::int32_t>;
using VectorArray = openvdb::points::TypedAttributeArray<openvdb::Vec3f>;

/// The two point grids of a cache file, wholly in memory.
struct CacheGrids {
    CacheHeader header;
    PointGrid::Ptr items;
    PointGrid::Ptr blocks;
};

/// Registers OpenVDB's types; once is enough.
void initializeOpenVdb();

inline openvdb::Coord toCoord(const Vec3i& v) {
    return {v.x, v.y, v.z};
}

/// The grids' place in world space.
openvdb::math::Transform::Ptr makeTransform(double spacing);

/// The grid in OpenVDB's terms.
openvdb::GridBase::Ptr makeVdbGrid(const CacheHeader& header, const std::vector<Vec3i>& voxels,
                                   const VolumeGrid& grid);

/// @throws Error naming the file and the cause
CacheGrids readGrids(const std::filesystem::path& path);

/// What a cache file says of itself. @throws Error as readGrids
CacheHeader readHeader(const std::filesystem::path& path);

/// Attribute of a leaf, type and stride checked.
///
/// @throws Error if it is not what the format says
template <class Array>
const Array& attribute(const PointLeaf& leaf, const char* name, openvdb::Index stride,
                       const std::filesystem::path& path);

}  // namespace shadowcache
