#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/cache/cache_header.h"
#include "common/cache/patch_code.h"
#include "common/math/vec.h"

namespace shadowcache {

class ShadowCache;

/// Adds `moreN` unoccluded of `moreD` rays (moreN <= moreD) to one pair of 8-bit counts. Where the
/// sum would pass 255, both counts are scaled down; 0 < n < d stays so and n = 0 or n = d stay
/// exact.
void addCounts(std::uint8_t& n, std::uint8_t& d, unsigned moreN, unsigned moreD);

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
    std::vector<std::uint16_t> hits;      ///< CacheHeader::hits an item: HitCode
    std::vector<std::uint16_t> emitters;  ///< one of CacheHeader::emitters an item: EmitterCode

    std::size_t size() const { return voxel.size(); }
};

/// Appends `more` behind `items`; the caller keeps the order.
void append(CacheItems& items, const CacheItems& more);

/// Whether item i of `a` stands before item j of `b` in the file's order.
bool itemBefore(const CacheItems& a, std::size_t i, const CacheItems& b, std::size_t j);

/// Side of a surface with unit normal `n`, 0 .. kSides - 1.
int sideOf(const Vec3f& n);

/// Whether two items of different layers of one voxel, with these unit normals, lie behind each
/// other.
inline bool areDepthLayers(const Vec3f& a, const Vec3f& b) {
    return a.dot(b) > 0.95f;
}

/// What becomes of an item that two caches have.
enum class Overlap {
    add,  ///< other rays: counts are added, blocks united
    keep  ///< the same rays, since a bake makes an item in one way only: it is kept once
};

/// Items of two caches of one set with the same tiers.
CacheItems mergeItems(const CacheItems& a, const CacheItems& b, const DirectionTiers& tiers,
                      Overlap overlap);

/// Writes a cache, with its grids for volume tools, to a temporary file that is then renamed.
///
/// @return size of the file in bytes
/// @throws Error when it cannot be written
std::uintmax_t writeCache(const std::filesystem::path& path, const CacheHeader& header,
                          const CacheItems& items);

/// Reads the header of a cache. @throws Error as readCache
CacheHeader readHeader(const std::filesystem::path& path);

/// What was checked of a file.
struct CacheCheck {
    CacheHeader header;
    std::size_t items = 0, checksums = 0;
    std::uint64_t bytes = 0;
};

/// Reads a file to its end, and checks it: every byte against its checksum, then the numbers that
/// lead from one to the other.
///
/// @throws Error as readCache(), naming what is damaged
CacheCheck verifyCache(const std::filesystem::path& path);

/// Reads a whole cache back.
///
/// @param header  receives the file's
/// @throws Error naming the file and the cause: missing, truncated, foreign, damaged, of another
/// format version
CacheItems readCache(const std::filesystem::path& path, CacheHeader& header);

/// A cache of these items that is in no file, as if it were read from one.
std::unique_ptr<ShadowCache> makeCache(const CacheHeader& header, const CacheItems& items);

/// All items of an open cache without a memory budget, as readCache() has them.
CacheItems itemsOf(const ShadowCache& cache);

}  // namespace shadowcache
