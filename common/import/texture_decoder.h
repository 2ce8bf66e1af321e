#pragma once

#include <string>
#include <string_view>

#include "common/mesh/material.h"

namespace shadowcache {

/// Decodes a PNG or JPEG.
///
/// @return a texture without texels if the bytes are none, and the reason in `cause`
Texture decodeTexture(std::string_view bytes, std::string& cause);

}  // namespace shadowcache
