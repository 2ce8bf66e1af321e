#pragma once

#include <filesystem>

#include "common/image/radiance_image.h"

namespace shadowcache {

/// The OpenEXR part of readRadiance; texels are as in the file, not repaired.
RadianceImage readExrRadiance(const std::filesystem::path& path);

}  // namespace shadowcache
