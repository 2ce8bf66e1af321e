#pragma once

#include <string>
#include <string_view>

#include "common/mesh/material.h"

namespace shadowcache {

/// Whether the bytes begin as a picture of a format that decodeTexture() reads.
bool isPicture(std::string_view bytes);

/// Decodes a PNG, JPEG or WebP.
///
/// @return a texture without texels if the bytes are none, and the reason in `cause`
Texture decodeTexture(std::string_view bytes, std::string& cause);

}  // namespace shadowcache
