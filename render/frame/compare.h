#pragma once

#include <filesystem>
#include <vector>

#include "common/image/image.h"
#include "render/frame/options.h"

namespace shadowcache {

/// The R, G and B of a rendered image, negative estimates included: of the region of `options`,
/// from an image of the whole frame or of the region.
///
/// @throws Error if it cannot be read, or is of another size
Image readReference(const std::filesystem::path& path, const RenderOptions& options);

/// Squared relative error of an image: (x - ref)^2 / (ref^2 + 0.01 mean(ref)^2) over pixels and
/// RGB.
struct RelativeError {
    double mean = 0;                             ///< relMSE
    double l2 = 0;                               ///< root of the mean of (x - ref)^2
    double p50 = 0, p99 = 0, p999 = 0, max = 0;  ///< over pixels (mean of the three colours)
};

/// @throws Error when the sizes differ
RelativeError relativeError(const Image& image, const Image& reference);

/// Mean colour over squares of `tile` pixels, row by row; a rest at the border is left out.
std::vector<Rgb> tileMeans(const Image& image, int tile);

}  // namespace shadowcache
