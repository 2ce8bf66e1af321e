#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/direction_mesh.h"

namespace shadowcache {

/// Version of the file format; raised on any change of its bytes or of the direction mesh.
inline constexpr int kCacheFormat = 5;
/// Version that is written where a cache has no emitters: a reader needs nothing newer.
inline constexpr int kCacheFormatWithoutEmitters = 4;
/// Oldest version that is still read (cache_header_file.cpp): it has no hits either.
inline constexpr int kOldestCacheFormat = 3;

/// Most rays of an item whose hits a cache may keep.
inline constexpr int kMostHits = 64;

/// Finest level of the direction mesh that counts may have.
inline constexpr int kMaxCacheLevel = 5;

/// Finer cells that share a block of counts.
inline constexpr int kBlockCells = 16;

/// How the counts of a cache refine in direction. The coarsest (base) level is 0 or 1, whichever
/// has the parity of the finest; every further tier is two levels finer, so that kBlockCells finer
/// counts share a block.
struct DirectionTiers {
    int finest;  ///< level of the direction mesh, 0 .. kMaxCacheLevel

    /// Level of the base cells, 0 or 1.
    constexpr int baseLevel() const { return finest & 1; }
    /// Level of the cells of `tier`, 0 .. refinements().
    constexpr int levelOf(int tier) const { return baseLevel() + 2 * tier; }
    /// Tiers finer than the base cells: 0, 1 or 2.
    constexpr int refinements() const { return finest / 2; }
    /// Number of base cells: 20 at level 0, 80 at level 1.
    constexpr std::uint32_t baseCells() const { return cellCount(baseLevel()); }
    /// Blocks that hold the base cells, the last one in part at level 0.
    constexpr std::uint32_t baseBlocks() const {
        return (baseCells() + kBlockCells - 1) / kBlockCells;
    }
    /// Key of the block that refines cell `parent` of `tier` (0: the base, or 1). In an item the
    /// blocks stand in the order of their keys.
    constexpr std::uint16_t blockKey(int tier, std::uint32_t parent) const {
        return static_cast<std::uint16_t>(parent + (tier == 0 ? 0u : baseCells()));
    }
};

/// What a cache holds of its set, if not all. Sides of voxels are counted: a bake makes all items
/// of a side or none.
struct CachePart {
    std::uint64_t sides = 0;       ///< that the cache holds
    std::uint64_t sidesOfSet = 0;  ///< that a whole bake would hold
    std::string shots;             ///< that it was baked for: texts joined by "; "
};

/// Shards of a bake, numbered from 0.
struct ShardRange {
    int first, last;  ///< both included

    bool operator==(const ShardRange&) const = default;
};

/// A bake of which a cache holds items.
struct BakeRecord {
    std::uint64_t seed = 1;                ///< of its random numbers
    int rays = 0;                          ///< per finest mixed region
    int shards = 1;                        ///< that the bake was divided into
    std::vector<ShardRange> held{{0, 0}};  ///< of these, ascending, none next to another

    /// Whether no shard is missing.
    bool whole() const { return held == std::vector<ShardRange>{{0, shards - 1}}; }
    bool operator==(const BakeRecord&) const = default;
};

/// "seed=1 rays=16 shards=1-3,5/8; seed=2 rays=16": shards as --shard counts them, from 1, and only
/// if some are missing.
std::string bakesText(const std::vector<BakeRecord>& bakes);

/// Reads bakesText(). @return none if the text is not of that form
std::optional<std::vector<BakeRecord>> parseBakes(std::string_view text);

/// "1-3,5": numbers from 1.
std::string shardsText(const std::vector<ShardRange>& shards);

/// Shards of the bake that are not held.
std::vector<ShardRange> missingShards(const BakeRecord& bake);

/// What a cache records of its bake; all of it is kept in the file's metadata.
struct CacheHeader {
    int format = kCacheFormat;      ///< of the file that it was read from
    int level = kMaxCacheLevel;     ///< finest direction level
    bool adaptive = true;           ///< blocks only where the direction explains visibility
    double spacing = 0;             ///< side of a voxel [world units]
    std::vector<BakeRecord> bakes;  ///< merged into it, in the order of merging
    std::string upAxis = "y";       ///< of the files the set was read from: "y" or "z"
    double unit = 1;                ///< metres per unit of those files
    std::uint64_t fingerprint = 0;  ///< hash of the set's triangles
    std::string version;            ///< of the program that baked
    std::optional<CachePart> part;  ///< none: all of the set
    int hits = 0;                   ///< rays of an item whose hits are kept; 0: none
    /// Hash of the shape of each emitter whose visibility is counted (Emitters::shapeOf).
    std::vector<std::uint64_t> emitters;

    /// How its counts refine in direction.
    DirectionTiers tiers() const { return {level}; }
    /// Rays per finest mixed region; of several bakes the most.
    int rays() const;
    /// Seeds of the bakes, joined by commas.
    std::string seeds() const;
};

/// Shapes of emitters, as the file has them: fingerprints joined by commas.
std::string shapesText(const std::vector<std::uint64_t>& shapes);
/// Reads shapesText(). @return none if the text is not of that form
std::optional<std::vector<std::uint64_t>> parseShapes(std::string_view text);

/// The fingerprint as sixteen hexadecimal digits, as the file and all messages have it.
std::string fingerprintText(std::uint64_t fingerprint);

}  // namespace shadowcache
