#pragma once

#include "common/mesh/material.h"

namespace shadowcache {

// Pictures put together from several: formats that have one for each channel, and ours.

/// The colour of one picture and the opacity of another, in the size of the larger. The opacity is
/// the other's own where it has any, else the mean of its colours as they are stored.
///
/// @param color    null: white
/// @param opacity  null: opaque, whatever `color` has
Texture colorWithOpacity(const Texture* color, const Texture* opacity);

/// The mean of the colours of one picture as green, of another as blue, as they are stored; 1 for
/// null.
Texture greenAndBlue(const Texture* green, const Texture* blue);

/// Whether any texel is not opaque.
bool isTransparent(const Texture& texture);

}  // namespace shadowcache
