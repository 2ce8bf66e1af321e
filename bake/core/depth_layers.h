#pragma once

#include <vector>

#include "bake/core/placement.h"
#include "common/cache/patch_code.h"

namespace shadowcache {

/// A part of a triangle as the rays of one side need it.
struct Piece {
    std::uint32_t triangle;  ///< its number in the world (placed_mesh.h)
    float area;
    Vec3f normal;  ///< unit, to the side
};

/// Parts the pieces of one side of `voxel` into layers: parallel surfaces that do not
/// touch, such as a door and the wall behind it, which see different parts of the sky.
///
/// @return 1 to kMaxDepthLayers groups of pieces, the lowest along the normal first
std::vector<std::vector<Piece>> splitDepthLayers(const TriangleMesh& mesh, const Box& voxel,
                                                 const std::vector<Piece>& pieces);

}  // namespace shadowcache
