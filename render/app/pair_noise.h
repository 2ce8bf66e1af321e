#pragma once

#include <array>
#include <vector>

namespace shadowcache {

/// Two pictures that differ in their random numbers alone: luminance by pixel.
using PicturePair = std::array<std::vector<double>, 2>;

/// Noise of one picture of each of two pairs of the same size that show the same: relMSE, in which
/// pixels darker than a tenth of the mean count as that [docs/estimator.md, relMSE].
///
/// What they show is the mean of all, weighted by how alike the two of a pair are: that of a pair
/// with fireflies would be as bright as these. It is measured over 5 x 5 pixels: one that a single
/// picture lights would be its own measure. By how much the mean of a pair is off there counts as
/// well: two pictures may be alike since both miss the light.
///
/// @param width  of the pictures [pixels]
std::array<double, 2> noiseOfPairs(const PicturePair& a, const PicturePair& b, int width);

}  // namespace shadowcache
