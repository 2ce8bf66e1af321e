#pragma once

// Private to the cache's .cpp files: names types of OpenVDB.

#include <array>
#include <cstdint>
#include <vector>

#include "common/cache/cache_header.h"
#include "common/cache/openvdb_grids.h"

namespace shadowcache {

/// Names in the file (docs/format.md).
/// Its value: kCacheFormat (cache_header.h).
inline constexpr const char* kFormatKey = "shadowcache_format";
inline constexpr const char* kItemGrid = "shadowcache_items";
inline constexpr const char* kBlockGrid = "shadowcache_blocks";

using PointGrid = openvdb::points::PointDataGrid;
using PointLeaf = openvdb::points::PointDataTree::LeafNodeType;
using ByteArray = openvdb::points::TypedAttributeArray<std::int8_t>;
using ShortArray = openvdb::points::TypedAttributeArray<std::int16_t>;
using IntArray = openvdb::points::TypedAttributeArray<std::int32_t>;
using VectorArray = openvdb::points::TypedAttributeArray<openvdb::Vec3f>;

/// An attribute of the points of a grid.
struct AttributeSpec {
    const char* name;
    openvdb::NamePair type;  ///< of OpenVDB: type of a value, and codec
    std::size_t valueBytes;
    openvdb::Index stride;  ///< values a point
};

/// Attributes of the items, as indices into itemAttributes(), in the file's order.
enum ItemAttribute : std::size_t {
    kPosition,
    kNormal,
    kPatch,
    kItemN,
    kItemD,
    kFirstBlock,
    kBlockCount,
    kHits,      ///< only of caches that keep hits
    kEmitters,  ///< only of caches that count emitters; in the place of kHits without hits
    kItemAttributes
};
/// Those that lookups use: all but kHits.
std::array<AttributeSpec, kHits> lookupAttributes(const DirectionTiers& tiers);
/// Place of kEmitters among itemAttributes().
inline std::size_t emitterPlace(const CacheHeader& header) {
    return header.hits > 0 ? kEmitters : kHits;
}
/// All of a cache.
std::vector<AttributeSpec> itemAttributes(const CacheHeader& header);

/// Attributes of the blocks, as indices into blockAttributes(), in the file's order. OpenVDB adds a
/// position to them, which is not used.
enum BlockAttribute : std::size_t { kKey, kBlockN, kBlockD, kBlockAttributes };
std::array<AttributeSpec, kBlockAttributes> blockAttributes();

/// Name of the attribute that OpenVDB makes the first of all points.
inline constexpr const char* kPositionName = "P";

}  // namespace shadowcache
