#pragma once

#include <string>
#include <string_view>

#include "common/mesh/material.h"

namespace shadowcache {

/// Whether the bytes begin as a WebP picture.
bool isWebp(std::string_view bytes);

/// Decodes a WebP picture that does not move.
///
/// @param mostTexels  a file of this size may have
/// @return a texture without texels if the bytes are damaged, and the reason in `cause`
Texture decodeWebp(std::string_view bytes, double mostTexels, std::string& cause);

}  // namespace shadowcache
