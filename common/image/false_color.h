#pragma once

#include "common/math/vec.h"

namespace shadowcache {

/// Linear colour for a number from 0 (dark violet) to 1 (yellow), clamped; even in lightness and
/// safe for colour-blind eyes. ["viridis", van der Walt & Smith 2015]
Rgb falseColor(double value);

}  // namespace shadowcache
