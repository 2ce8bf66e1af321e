#pragma once

#include <cstdint>
#include <filesystem>

namespace shadowcache {

/// Bytes that a cache's hits take in its file; 0 if it keeps none.
///
/// @throws Error naming the file and the cause: missing, truncated, foreign, of another format
/// version, or not laid out as shadowcache-bake does it
std::uint64_t hitBytes(const std::filesystem::path& path);

}  // namespace shadowcache
