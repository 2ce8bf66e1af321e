#pragma once

#include <cstddef>
#include <vector>

#include "common/math/vec.h"

namespace shadowcache {

/// What the filter knows of a pixel.
struct ResidualPixel {
    Rgb residual{0, 0, 0};  ///< what rays add to the predicted irradiance, colour of the surface
                            ///< divided out
    float variance = 0;     ///< of its luminance
    Vec3f normal{0, 0, 0};  ///< unit
    Vec3f position{0, 0, 0};
    float width = 0;  ///< of the pixel at its position [length]; 0: no surface, not filtered
};

/// Pixels, row by row.
struct ResidualImage {
    int width = 0;
    int height = 0;
    std::vector<ResidualPixel> pixels;
};

/// A filtered pixel depends on others up to so far from it. [pixels]
inline constexpr int kResidualReach = 18;

/// Smooths the noise of the residuals, and replaces the variances by those that are left: an
/// edge-avoiding a-trous wavelet [Dammertz et al. 2010] that is the wider the more variance there
/// is [Schied et al. 2017]. Neighbours count if they lie in the plane of a pixel, have its normal,
/// and a residual that differs by no more than the noise explains; so where the variance is 0,
/// pixels stay as they are. Of equal bits for any number of threads, and for a part of the image
/// beyond kResidualReach from where it was cut.
///
/// @param luminanceWeights  of the colours
void filterResiduals(ResidualImage& image, const Rgb& luminanceWeights);

}  // namespace shadowcache
