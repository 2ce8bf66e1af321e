#pragma once

#include <filesystem>

#include "common/image/radiance_image.h"

namespace shadowcache {

/// The Radiance HDR part of readRadiance: RGBE, flat or with runs of either kind, in any of the
/// eight orientations, divided by EXPOSURE and COLORCORR. Texels may be infinite.
///
/// @throws Error naming the file and the cause
RadianceImage readHdr(const std::filesystem::path& path);

}  // namespace shadowcache
