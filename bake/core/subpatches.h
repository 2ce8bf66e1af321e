#pragma once

#include <span>

#include "bake/core/base_cells.h"
#include "bake/core/item_counts.h"

namespace shadowcache {

/// Whether the subpatches see such different amounts of sky that one item could not stand for all
/// of them.
bool seeDifferentSky(const Subdivision& subdivision, const BaseCells& base);

/// Whether there are four subpatches with about the same area, so that their rays together are
/// spread over the whole patch.
bool areAlikeInSize(std::span<const Patch> subpatches);

}  // namespace shadowcache
