#pragma once

#include "common/image/radiance.h"

namespace shadowcache {

/// The OpenEXR part of readRadiance; texels are as in the file, not mended.
RadianceImage readExrRadiance(const std::filesystem::path& path);

}  // namespace shadowcache
