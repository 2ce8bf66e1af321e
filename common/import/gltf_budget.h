#pragma once

#include <cstddef>

#include "common/import/gltf_document.h"

namespace shadowcache {

/// What a file may become in memory. Primitives, animations and textures may share the bytes of a
/// buffer, and accessors without bytes are zeros, so that a small file could ask for any amount.
class GltfBudget {
public:
    /// @param document outlives the budget
    explicit GltfBudget(const GltfDocument& document);

    /// Takes vertices, corners, numbers of keys or texels.
    ///
    /// @throws Error naming the file when they are too many for its size
    void take(std::size_t elements);

private:
    const GltfDocument& document_;
    std::size_t taken_ = 0, most_;
};

}  // namespace shadowcache
