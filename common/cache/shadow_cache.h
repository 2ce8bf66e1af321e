#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "common/cache/cache_header.h"
#include "common/cache/memory_use.h"
#include "common/math/vec.h"

namespace shadowcache {

/// Counts of kBlockCells cells of an item.
struct BlockCounts {
    const std::uint8_t* n;  ///< rays that reached the sky, by cell
    const std::uint8_t* d;  ///< rays counted, by cell; n <= d, and 0: nothing is known
};

/// One item near a place, as a view into an open cache.
struct ItemView {
    const std::uint8_t* n;          ///< rays that reached the sky, by base cell
    const std::uint8_t* d;          ///< rays counted, by base cell; n <= d, and 0: nothing is known
    const std::int16_t* blockKeys;  ///< DirectionTiers::blockKey of each block, ascending
    const std::uint8_t* blockN;     ///< kBlockCells counts n of the first block
    const std::uint8_t* blockD;     ///< kBlockCells counts d of the first block
    std::uint32_t blockNStep;       ///< from one block's n to the next; 0 if all blocks are alike
    std::uint32_t blockDStep;       ///< from one block's d to the next; 0 if all blocks are alike
    std::uint32_t blockCount;       ///< blocks, the finer counts
    Vec3f normal;                   ///< unit mean normal of the item's surface, world space
    float weight;                   ///< share in the lookup, in (0, 1]; shares of a lookup sum to 1
    std::uint64_t number;           ///< of the item in the open cache, from 0

    /// Block `k` < blockCount.
    BlockCounts block(std::size_t k) const {
        return {blockN + k * blockNStep, blockD + k * blockDStep};
    }

    /// The block that has `key`, or -1.
    int findBlock(std::uint16_t key) const {
        // Bisects long lists. Counting through a short one is faster than branching.
        std::uint32_t first = 0, count = blockCount;
        while (count > 64) {
            const std::uint32_t half = count / 2;
            const bool above = blockKeys[first + half] < key;
            first += above ? half : 0;
            count = above ? count - half : half;
        }
        std::int16_t before = 0;
        for (std::uint32_t k = first; k < first + count; ++k)
            before = static_cast<std::int16_t>(before + (blockKeys[k] < key));
        const std::uint32_t found = first + static_cast<std::uint32_t>(before);
        return found < blockCount && blockKeys[found] == key ? static_cast<int>(found) : -1;
    }
};

/// An open cache: items found by place and normal. Immutable; all members are thread-safe. All of
/// it is in memory or, with a budget, what is in use.
class ShadowCache {
public:
    /// Most items that one lookup finds.
    static constexpr int kMaxItems = 32;

    /// @param path          a file written by shadowcache-bake or shadowcache-merge
    /// @param memoryBudget  bytes of memory to keep to, as far as the lookups under way allow;
    ///                      0: reads the whole file now
    /// @throws Error naming the file and the cause: missing, truncated, foreign, damaged, of
    /// another format version
    explicit ShadowCache(const std::filesystem::path& path, std::uint64_t memoryBudget = 0);
    ~ShadowCache();
    ShadowCache(const ShadowCache&) = delete;
    ShadowCache& operator=(const ShadowCache&) = delete;

    /// What the cache records of its bake.
    const CacheHeader& header() const;
    /// Number of items.
    std::size_t itemCount() const;
    /// Number of blocks of finer counts.
    std::size_t blockCount() const;
    /// Bytes of memory that the items and their index take now.
    std::size_t memoryBytes() const;
    /// Use of the memory budget; all 0 without one.
    MemoryUse memoryUse() const;

    /// A thread's access to the cache; keeps the nodes it last visited. One Reader a thread.
    class Reader {
    public:
        /// @param cache  stays open as long as the reader
        explicit Reader(const ShadowCache& cache);
        ~Reader();
        Reader(Reader&&) noexcept;

        /// Items of the 8 voxels around a place whose normals are within 60 degrees of `normal`,
        /// weighted trilinearly and by their distance from the plane of the place. Subpatches
        /// replace the patches that they were cut from. [docs/format.md, Pooling]
        ///
        /// @param position world space
        /// @param normal   unit, towards the side that is lit
        /// @param out      receives the items; at least kMaxItems
        /// @return number of items found, 0 away from the set's surfaces. Their views are valid as
        /// long as the cache is open; with a memory budget, until the next call
        /// @throws Error naming the file if there is a budget and the file cannot be read any more
        int lookUp(const Vec3d& position, const Vec3f& normal, std::span<ItemView> out);

        /// An item by its number, below itemCount(); its weight is 1. Fast where numbers ascend.
        /// Valid, and throws, as what lookUp() finds.
        ItemView item(std::uint64_t number);

    private:
        struct Impl;
        std::unique_ptr<Impl> impl_;
    };

private:
    friend struct OpenCache;  // for the cache's own .cpp files

    struct Impl;
    explicit ShadowCache(std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
};

}  // namespace shadowcache
