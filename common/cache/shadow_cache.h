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

/// Finer counts of one region: kBlockCells open and all rays.
struct BlockCounts {
    const std::uint8_t* n;
    const std::uint8_t* d;
};

/// One item near a place, as a view into an open cache.
struct ItemView {
    const std::uint8_t* n;  ///< baseCells counts
    const std::uint8_t* d;
    const std::int16_t* blockKeys;  ///< sorted
    const std::uint8_t* blockN;     ///< kBlockCells counts of the first block
    const std::uint8_t* blockD;
    std::uint32_t
        blockNStep;  ///< from one block's counts to the next: kBlockCells, or 0 if all are alike
    std::uint32_t blockDStep;
    std::uint32_t blockCount;
    Vec3f normal;
    float weight;          ///< share in the pooled counts; those of one lookup sum to 1
    std::uint64_t number;  ///< of the item in the open cache, from 0 on

    /// Its k-th block.
    BlockCounts block(std::size_t k) const {
        return {blockN + k * blockNStep, blockD + k * blockDStep};
    }

    /// Which of its blocks has `key`; -1: none.
    int findBlock(std::uint16_t key) const {
        // Halves long lists. To count all of a short one is faster than to branch.
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

/// An open cache: items found by place and normal through OpenVDB. Lookups are thread-safe through
/// one Reader a thread. All of it is in memory, or, with a budget, what is in use.
class ShadowCache {
public:
    /// Most items that one lookup pools.
    static constexpr int kMaxItems = 32;

    /// @param memoryBudget  bytes of memory to keep to, as far as what is looked at at one time
    ///                      allows; 0: reads the whole file now
    /// @throws Error naming the file and the cause: missing, truncated, foreign, of another format
    /// version
    explicit ShadowCache(const std::filesystem::path& path, std::uint64_t memoryBudget = 0);
    ~ShadowCache();
    ShadowCache(const ShadowCache&) = delete;
    ShadowCache& operator=(const ShadowCache&) = delete;

    const CacheHeader& header() const;
    std::size_t itemCount() const;
    std::size_t blockCount() const;
    /// Memory of the items and of the grid around them, now.
    std::size_t memoryBytes() const;
    /// What the budget came to, if there is one.
    MemoryUse memoryUse() const;

    /// A thread's access to the cache; remembers the nodes it last visited.
    class Reader {
    public:
        explicit Reader(const ShadowCache& cache);
        ~Reader();
        Reader(Reader&&) noexcept;

        /// Items of the 8 voxels around a place whose side agrees with the unit normal, weighted
        /// trilinearly and by their distance from the plane of the place; parts of patches go
        /// before whole ones where they reach. Of more than kMaxItems the first in the file count.
        ///
        /// @param position world space
        /// @param out      at least kMaxItems
        /// @return number of items found; with a budget they are valid until the next call
        /// @throws Error naming the file if there is a budget and the file cannot be read any more
        int lookUp(const Vec3d& position, const Vec3f& normal, std::span<ItemView> out);

    private:
        struct Impl;
        std::unique_ptr<Impl> impl_;
    };

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace shadowcache
