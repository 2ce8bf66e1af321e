#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace shadowcache {

/// Which files a file of a set may name: those in its folder and below, or any.
enum class References { inside, anywhere };

/// Whether `file` is in the folder of `set`, or below. Symbolic links are followed, so that one
/// that leads out of the folder counts as outside.
bool isBeside(const std::filesystem::path& set, const std::filesystem::path& file);

/// The file that a glTF file names by a URI, whether it exists or not: relative to the glTF file's
/// folder, unless it begins with '/'.
std::filesystem::path referencedFile(const std::filesystem::path& set, const std::string& uri);

/// A URI with its escapes replaced: "%20" is a blank.
std::string decodedUri(const std::string& uri);

/// The file that a file of a set names, with a backslash for a slash, or without the quotes around
/// it, where that finds it.
///
/// @param base  the file that names it: `set`, or one beside it
/// @return nothing if there is no such regular file
/// @throws Error naming `set` if it is outside of its folder and `references` are inside
std::optional<std::filesystem::path> namedFile(const std::filesystem::path& set,
                                               const std::filesystem::path& base,
                                               const std::string& name, References references);

}  // namespace shadowcache
