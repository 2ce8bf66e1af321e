#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "bake/core/options.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

/// What messages call the emitters that a bake counts (emitterLabel).
std::vector<std::string> emitterLabels(const TriangleMesh& mesh, const BakeOptions& options);

/// Emitters that a cache is to count.
struct WantedEmitters {
    const std::vector<std::uint64_t>& shapes;  ///< CacheHeader::emitters
    std::string owner;                         ///< what counts them, for messages
    std::span<const std::string> labels = {};  ///< emitterLabels(); none: unknown
};

/// Refuses a cache that counts other emitters.
///
/// @param path   of the cache
/// @param found  CacheHeader::emitters of it
/// @throws Error naming the file and what differs: in words, since hashes say nothing
void requireSameEmitters(const std::filesystem::path& path, const std::vector<std::uint64_t>& found,
                         const WantedEmitters& wanted);

}  // namespace shadowcache
