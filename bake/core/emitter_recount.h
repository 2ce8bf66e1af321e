#pragma once

#include <cstdint>
#include <filesystem>

#include "bake/core/options.h"
#include "bake/core/voxel_frame.h"
#include "common/cache/cache_items.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// Counts the rays to emitters of items that were baked without them. The items become those of a
/// bake with them. Shows progress; Ctrl-C ends it with Error.
///
/// @param options  that the items were baked with, and with lamps
/// @param path     of the items, for messages
/// @return number of rays traced
/// @throws Error naming the file if an item is not of the set
std::uint64_t recountEmitters(const Scene& scene, const BakeOptions& options,
                              const VoxelFrame& frame, const std::filesystem::path& path,
                              CacheItems& items);

}  // namespace shadowcache
