#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/cache/patch_code.h"
#include "common/math/direction_mesh.h"
#include "common/math/vec.h"

namespace shadowcache {

/// How the counts of a cache refine in direction. The coarsest (base) level is 0 or 1, whichever
/// has the parity of the finest; every further tier is two levels finer, so that 16 finer counts
/// share a block.
struct DirectionTiers {
    int finest;  ///< 0 .. 5

    constexpr int baseLevel() const { return finest & 1; }
    /// 0 (base cells only), 1 or 2.
    constexpr int refinements() const { return finest / 2; }
    constexpr std::uint32_t baseCells() const { return cellCount(baseLevel()); }
    /// Key of the block that refines cell `parent` of tier `tier` (0: the base, 1). Keys fit 16
    /// bits; in an item the blocks stand in the order of their keys.
    constexpr std::uint16_t blockKey(int tier, std::uint32_t parent) const {
        return static_cast<std::uint16_t>(parent + (tier == 0 ? 0u : baseCells()));
    }
};

inline constexpr int kMaxCacheLevel = 5;
inline constexpr int kBlockCells = 16;

/// Adds `n` unoccluded of `d` rays to one pair of 8-bit counts. Where the sum would pass 255, both
/// counts are scaled down; 0 < n < d stays so and n = 0 or n = d stay exact.
void addCounts(std::uint8_t& n, std::uint8_t& d, unsigned moreN, unsigned moreD);

/// What a cache says of itself; everything is kept in the file's metadata.
struct CacheHeader {
    int level = kMaxCacheLevel;     ///< finest direction level
    bool adaptive = true;           ///< blocks only where rays disagreed
    double spacing = 0;             ///< side of a voxel, world units
    int rays = 0;                   ///< rays per finest mixed region
    std::string seeds;              ///< of the bakes merged into it, in the order of merging
    std::string upAxis = "y";       ///< of the files the set was read from
    double unit = 1;                ///< metres per unit of those files
    std::uint64_t fingerprint = 0;  ///< of the set
    std::string version;            ///< of the program that baked

    DirectionTiers tiers() const { return {level}; }
};

/// Sixteen hexadecimal digits, as files and people have it.
std::string fingerprintText(std::uint64_t fingerprint);

/// Format of the file; raised on any change of its bytes or of the direction mesh.
inline constexpr int kCacheFormat = 2;

/// Sixteen finer counts of one region of an item.
struct CountBlock {
    std::uint16_t key;  ///< DirectionTiers::blockKey
    std::array<std::uint8_t, kBlockCells> n, d;
};

/// Cache items as plain arrays, sorted by voxel (OpenVDB's leaf order) and patch. An item is one
/// side of the surface in one voxel, or one layer of it where parallel layers lie behind each
/// other, or part of that where the visibility changes across it.
struct CacheItems {
    std::vector<Vec3i> voxel;
    std::vector<std::int16_t> patch;  ///< PatchCode, packed
    std::vector<Vec3f> normal;        ///< unit mean normal of the patch
    std::vector<Vec3f> position;  ///< mean point of the patch in its voxel, [-0.5, 0.5] spacings
    std::vector<std::uint8_t> n;  ///< baseCells an item: rays that reached the sky
    std::vector<std::uint8_t> d;  ///< baseCells an item: rays counted
    std::vector<std::uint32_t> firstBlock{0};  ///< items + 1 offsets into blocks
    std::vector<CountBlock> blocks;

    std::size_t size() const { return voxel.size(); }
};

/// Appends `more` behind `items`.
void append(CacheItems& items, const CacheItems& more);

/// Whether item i of `a` stands before item j of `b` in the file's order.
bool itemBefore(const CacheItems& a, std::size_t i, const CacheItems& b, std::size_t j);

/// Side of a surface with unit normal `n`, 0 .. 5.
int sideOf(const Vec3f& n);

/// Whether two items of different layers of one voxel, with these unit normals, lie behind each
/// other.
inline bool areDepthLayers(const Vec3f& a, const Vec3f& b) {
    return a.dot(b) > 0.95f;
}

/// Sum of two caches of one set: items of both, counts added, blocks united.
CacheItems mergeItems(const CacheItems& a, const CacheItems& b, const DirectionTiers& tiers);

/// Writes a cache, with its grids for volume tools; beside it first, then renamed.
///
/// @return bytes written
/// @throws Error when it cannot be written
std::uintmax_t writeCache(const std::filesystem::path& path, const CacheHeader& header,
                          const CacheItems& items);

/// Reads a whole cache back.
///
/// @throws Error naming the file and the cause: missing, truncated, foreign, of another format
/// version
CacheItems readCache(const std::filesystem::path& path, CacheHeader& header);

}  // namespace shadowcache
