#pragma once

#include <cstdint>
#include <filesystem>

namespace shadowcache {

/// Bytes that parts of a cache take in its file; 0 of what it does not have.
struct StoredBytes {
    std::uint64_t hits = 0;
    std::uint64_t emitters = 0;  ///< counts of the rays to emitters
};

/// @throws Error naming the file and the cause: missing, truncated, foreign, of another format
/// version, or not laid out as shadowcache-bake does it
StoredBytes storedBytes(const std::filesystem::path& path);

}  // namespace shadowcache
