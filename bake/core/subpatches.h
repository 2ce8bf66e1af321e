#pragma once

#include <span>

#include "bake/core/item_baker.h"

namespace shadowcache {

/// Whether the subpatches of a patch, of which `probes` are the first rays, see such different
/// amounts of sky that one item could not stand for all of them.
bool seeDifferentSky(std::span<const Patch> subpatches, std::span<const Probe> probes,
                     const BaseCells& base);

/// Whether all subpatches hold about as much surface, so that their rays together are spread over
/// the patch.
bool areAlikeInSize(std::span<const Patch> subpatches);

}  // namespace shadowcache
