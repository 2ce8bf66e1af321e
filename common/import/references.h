#pragma once

#include <filesystem>
#include <string>

namespace shadowcache {

/// Which files a glTF file may name: those in its folder and below, or any.
enum class References { inside, anywhere };

/// Whether `file` is in the folder of `set`, or below. Symbolic links are followed, so that one
/// that leads out of the folder counts as outside.
bool isBeside(const std::filesystem::path& set, const std::filesystem::path& file);

/// The file that a glTF file names by a URI, whether it exists or not: relative to the glTF file's
/// folder, unless it begins with '/'.
std::filesystem::path referencedFile(const std::filesystem::path& set, const std::string& uri);

}  // namespace shadowcache
