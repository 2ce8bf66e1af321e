#pragma once

#include <filesystem>

namespace shadowcache {

/// Refuses a file that would be read whole, but is larger than the memory that this process may
/// have. That a file is missing is left to who reads it.
///
/// The limit that users set with --memory is another one: bytesOf() reads its text (option_text.h);
/// caches are read within it in common/cache/budgeted_pages.h, bakes keep to it in
/// bake/core/checkpoint.h.
///
/// @throws Error naming both
void requireFitsMemory(const std::filesystem::path& path);

}  // namespace shadowcache
