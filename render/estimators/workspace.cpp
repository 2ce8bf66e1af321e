#include "render/estimators/workspace.h"

namespace shadowcache {

std::span<const std::uint32_t> Workspace::numbers(Sequence sequence, std::uint64_t seed,
                                                  int dimension, std::uint32_t first, int count) {
    std::vector<std::uint32_t>& out = numbers_[dimension];
    out.resize(static_cast<std::size_t>(count));
    sequence.fill(first, dimension, seed, out);
    return out;
}

}  // namespace shadowcache
