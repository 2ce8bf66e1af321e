#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "common/cache/checksums.h"
#include "common/cache/memory_use.h"

namespace shadowcache {

/// A part of a cache file that is unpacked as a whole.
struct FilePage {
    /// How its bytes are packed.
    enum class Kind : std::uint8_t {
        plain,      ///< not at all
        blosc,      ///< as one Blosc buffer
        voxelEnds,  ///< of several leaves, each packed on its own
    };

    std::uint64_t offset;  ///< in the file
    std::uint32_t stored;  ///< bytes there
    std::uint32_t size;    ///< bytes when unpacked
    Kind kind;             ///< how its bytes are packed
};

/// A page in memory, which stays as long as a pin refers to it.
using PagePin = std::shared_ptr<const std::byte[]>;

/// Pages of a file, read on demand; the least recently used are dropped when they exceed a budget.
/// Thread-safe.
class BudgetedPages {
public:
    /// @param budget    bytes
    /// @param overhead  bytes that the owner keeps for the file beside the pages; part of the
    /// budget
    BudgetedPages(CheckedFile file, std::vector<FilePage> pages, std::uint64_t budget,
                  std::uint64_t overhead);
    BudgetedPages(const BudgetedPages&) = delete;
    BudgetedPages& operator=(const BudgetedPages&) = delete;

    /// Bytes of a page when unpacked.
    std::uint32_t size(std::uint32_t page) const { return pages_[page].size; }

    /// Pins pages[i] in pins[i] if all are in memory; otherwise does nothing.
    ///
    /// @return whether all were
    bool pinHeld(std::span<const std::uint32_t> pages, std::span<PagePin> pins);

    /// The page, read first unless it is in memory. Pinned pages stay even beyond the budget.
    ///
    /// @throws Error naming the file if the page cannot be read or differs from its checksums
    PagePin pin(std::uint32_t page);

    /// Budget and use so far.
    MemoryUse use() const;

private:
    struct Slot {
        PagePin bytes;  ///< null: not in memory
        bool loading = false;
        std::list<std::uint32_t>::iterator place;  ///< in recent_, if in memory
    };

    CheckedFile file_;
    std::vector<FilePage> pages_;

    mutable std::mutex mutex_;
    std::condition_variable loaded_;
    std::vector<Slot> slots_;
    std::list<std::uint32_t> recent_;  ///< pages in memory, the last used first
    MemoryUse use_;

    void makeRoom(std::uint64_t bytes);
    PagePin load(const FilePage& page) const;
    void readAt(std::uint64_t offset, std::span<std::byte> out) const;
    PagePin touch(std::uint32_t page);
};

}  // namespace shadowcache
