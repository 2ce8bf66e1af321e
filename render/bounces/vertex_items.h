#pragma once

#include <cstdint>
#include <span>

#include "common/cache/item_table.h"
#include "render/bounces/path_vertex.h"

namespace shadowcache {

/// Sets the items that predict the irradiance of some vertices of a level, all of the set itself.
///
/// @param origin  of the set, world space
void findItems(const ItemTable& items, const Vec3d& origin, std::span<const std::uint32_t> vertices,
               PathLevel& level);

}  // namespace shadowcache
