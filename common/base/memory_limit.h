#pragma once

#include <filesystem>

namespace shadowcache {

/// Refuses a file that would be read whole, but is larger than the memory that this process may
/// have. What is no file at all is left to who reads it.
///
/// @throws Error naming both
void requireFitsMemory(const std::filesystem::path& path);

}  // namespace shadowcache
