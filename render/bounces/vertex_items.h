#pragma once

#include <cstdint>
#include <span>

#include "common/cache/item_table.h"
#include "render/bounces/path_vertex.h"

namespace shadowcache {

/// Sets the items that predict the irradiance of vertices, by number: all are of the set itself.
///
/// @param origin  of the set, world space
void findItems(const ItemTable& items, const Vec3d& origin, std::span<const std::uint32_t> numbers,
               std::span<PathVertex> vertices);

}  // namespace shadowcache
