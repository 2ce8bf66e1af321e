#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/import/references.h"

namespace shadowcache {

/// A file of a set and those that it refers to, as far as they exist and may be read: buffers and
/// images of a glTF file, libraries of materials of an OBJ file and their images.
std::vector<std::filesystem::path> filesOf(const std::filesystem::path& file,
                                           References references);

/// Hash of what the files, and those that they refer to, contain, in their order: the same for
/// copies under other names and dates. Paths that are no files are left out.
///
/// @throws Error naming a file that cannot be read
std::string contentHashOf(std::span<const std::filesystem::path> files, References references);

}  // namespace shadowcache
