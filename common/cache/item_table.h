#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/cache/shadow_cache.h"

namespace shadowcache {

/// Stands for no item where the number of one is wanted.
inline constexpr std::uint32_t kNoItem = 0xfffffffe;

/// Where the items of an open cache are, in memory: by number, as ItemView::number gives it, and by
/// place. Immutable and thread-safe; does not need the cache once it is made.
class ItemTable {
public:
    /// @throws Error naming the cache's file if that cannot be read any more; without a name if the
    /// cache has more items than 32 bits can number
    explicit ItemTable(const ShadowCache& cache);

    /// Number of items.
    std::size_t size() const { return items_.size(); }
    /// Side of a voxel [world units].
    double spacing() const { return spacing_; }
    /// Mean point of the item's surface, world space.
    Vec3d position(std::uint32_t item) const {
        return (Vec3d(items_[item].voxel) + Vec3d(items_[item].position)) * spacing_;
    }
    /// Unit mean normal of the item's surface, world space.
    const Vec3f& normal(std::uint32_t item) const { return items_[item].normal; }

    /// Share of the item's surface that is exposed, above 0: of the rays whose hits the cache
    /// keeps, those that got away from it. The rest starts where another surface hides it, which
    /// nobody sees and the sky does not light. 1 without hits.
    float exposure(std::uint32_t item) const { return items_[item].exposure; }

    /// Whether a lookup at the item's own place, for its own normal, finds it. Others have parts or
    /// a nearer layer in their place, and are asked for by nobody.
    bool isFound(std::uint32_t item) const { return items_[item].found; }

    /// The item that would weigh most in a lookup at a place (ShadowCache::Reader::lookUp)
    /// that counts items as far as they are exposed, or kNoItem if a lookup would find none. Of
    /// equal ones the first.
    ///
    /// @param position  world space
    /// @param normal    unit, towards the side that is lit
    std::uint32_t itemAt(const Vec3d& position, const Vec3f& normal) const noexcept;

    /// The same of the items of one side, whatever their normals.
    ///
    /// @param place  world space, in spacings; may lie up to a voxel beside the item
    /// @param side   of PatchCode
    std::uint32_t itemOfSide(const Vec3d& place, int side) const noexcept;

    /// Bytes of memory that it takes.
    std::size_t memoryBytes() const;

    /// What a cache records of an item, without its counts.
    struct Item {
        Vec3i voxel;
        std::int16_t patch;  ///< PatchCode, packed
        bool found;          ///< as isFound()
        Vec3f position;      ///< from the voxel's centre, in spacings
        Vec3f normal;
        float exposure;  ///< of its surface, above 0, up to 1
    };
    const Item& item(std::uint32_t number) const { return items_[number]; }
    /// All items, by number.
    std::span<const Item> all() const { return items_; }

private:
    std::uint32_t slotOf(const Vec3i& voxel) const noexcept;
    void index();
    void look(const ShadowCache& cache);

    template <class Weigh>
    std::uint32_t heaviest(const Vec3d& place, int low, int high,
                           const Weigh& weigh) const noexcept;

    double spacing_;
    std::vector<Item> items_;
    std::vector<std::uint32_t> slots_;  ///< hashed by voxel: its first item, or kNoItem
};

}  // namespace shadowcache
