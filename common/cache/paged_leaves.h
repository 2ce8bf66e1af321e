#pragma once

// Private to the cache's .cpp files: names types of OpenVDB.

#include <array>

#include "common/cache/budgeted_pages.h"
#include "common/cache/leaf_view.h"
#include "common/cache/point_layout.h"

namespace shadowcache {

/// The leaves of a cache of which only the pages in use are in memory. Thread-safe.
class PagedLeaves {
public:
    /// @param budget  bytes of memory
    /// @throws Error naming the file and the cause
    PagedLeaves(const std::filesystem::path& path, const CacheHeader& header, std::uint64_t budget);

    /// Number of items.
    std::size_t items() const { return items_; }
    /// Number of blocks.
    std::size_t blocks() const { return blocks_; }
    /// Number of leaves.
    std::size_t size() const { return leaves_.size(); }
    /// First voxel of a leaf, in the file's order.
    const openvdb::Coord& origin(std::size_t leaf) const { return leaves_[leaf].items.origin; }
    /// The leaf that holds an item, by number.
    std::size_t leafWith(std::uint64_t item) const;
    /// Use of the budget.
    MemoryUse use() const { return pages_->use(); }

    /// A thread's access; keeps the leaves it last visited. One Reader a thread.
    class Reader {
    public:
        /// @param hits  reads them and the emitters, too; without, the views have none
        explicit Reader(const PagedLeaves& leaves, bool hits = false);

        /// Begins another lookup: leaves of the last one may be released.
        void beginLookup() { ++now_; }
        /// The leaf around a voxel, or null; valid until the next lookup begins. At most eight
        /// leaves a lookup.
        ///
        /// @throws Error naming the file if the leaf cannot be read
        const LeafView* find(const openvdb::Coord& voxel);

    private:
        static constexpr std::size_t kPlaces = 1 + kItemAttributes + kBlockAttributes;

        struct Slot {
            std::int32_t leaf = -1;
            std::uint64_t used = 0;  ///< lookup
            LeafView view;
            std::array<PagePin, kPlaces> pins;
        };

        const PagedLeaves& leaves_;
        std::uint32_t hitsPerItem_, emittersPerItem_;
        std::size_t attributes_;  ///< of the items that are read
        openvdb::tree::ValueAccessor<const openvdb::Int32Tree> accessor_;
        std::uint64_t now_ = 0;
        std::array<Slot, 8> slots_;

        void fill(Slot& slot, std::int32_t leaf);
        void releaseOthers();
    };

private:
    struct Leaf {
        LeafPlace items;
        std::int32_t blocks;  ///< in blockLeaves_; -1: none
        std::uint64_t firstItem;
    };

    std::filesystem::path path_;
    DirectionTiers tiers_;
    int hits_;
    std::uint32_t emitters_;
    std::size_t emitterPlace_;  ///< among the items' attributes
    std::vector<Leaf> leaves_;
    PointLayout blockLeaves_;
    openvdb::Int32Tree index_{-1};  ///< by leaf, in leaf_; -1: none
    std::size_t items_ = 0, blocks_ = 0;
    std::unique_ptr<BudgetedPages> pages_;
};

}  // namespace shadowcache
