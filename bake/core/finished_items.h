#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "bake/core/checkpoint.h"
#include "bake/core/region_bytes.h"

namespace shadowcache {

/// Items of finished regions, in memory or, if they may not stay there (Checkpoint::mayKeep), in
/// the checkpoint.
class FinishedItems {
public:
    /// @param checkpoint  has the items of every region that is set; null: all stay in memory
    FinishedItems(std::size_t regions, Checkpoint* checkpoint)
        : checkpoint_(checkpoint), kept_(regions), sizes_(regions) {}

    /// Thread-safe for different regions.
    void set(std::size_t region, Baked baked);

    /// All of them, in the order of the regions; they are forgotten.
    ///
    /// @throws Error if the checkpoint has lost one
    Baked joined();

private:
    struct Size {
        std::size_t items, counts, blocks, hits, emitters;
    };

    Baked take(std::size_t region);
    void reserve(CacheItems& all) const;

    Checkpoint* checkpoint_;
    std::vector<std::optional<Baked>> kept_;
    std::vector<Size> sizes_;
};

}  // namespace shadowcache
