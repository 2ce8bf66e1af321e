#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/cache/shadow_cache.h"

namespace shadowcache {

/// How much of each emitter of a set the items of a cache see. Immutable, thread-safe.
class EmitterVisibility {
public:
    /// Stands for a share that is not known.
    static constexpr float kUnknown = -1;

    /// Rays of an item to an emitter.
    struct Count {
        std::uint8_t visible = 0, rays = 0;
    };

    /// @param counts  of each emitter by item (ItemView::number), item by item
    EmitterVisibility(std::size_t emitters, std::vector<Count> counts)
        : emitters_(emitters), counts_(std::move(counts)) {}

    std::size_t emitters() const { return emitters_; }

    /// Visible share of each emitter, by what the items of a lookup counted together; kUnknown
    /// where they counted nothing.
    ///
    /// @param shares  emitters() numbers
    void shares(std::span<const ItemView> items, std::span<float> shares) const noexcept;
    /// The same of one item.
    void shares(std::uint64_t item, std::span<float> shares) const noexcept;

    std::size_t memoryBytes() const { return counts_.capacity() * sizeof counts_[0]; }

private:
    std::size_t emitters_;
    std::vector<Count> counts_;
};

}  // namespace shadowcache
