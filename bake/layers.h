#pragma once

#include <vector>

#include "bake/placement.h"

namespace shadowcache {

/// A fragment as the rays of one side need it.
struct Piece {
    const Fragment* fragment;
    Vec3f normal;  ///< unit, to the side
};

/// Most layers of one side in a voxel.
inline constexpr std::size_t kMaxLayers = 4;

/// Parts the pieces of one side of a voxel into layers: parallel sheets of surface that do not
/// touch, such as a door and the wall behind it. What one sees, the next may not.
///
/// @return 1 to kMaxLayers groups of pieces, the lowest along the normal first
std::vector<std::vector<Piece>> splitLayers(const TriangleMesh& mesh, const VoxelFrame& frame,
                                            const std::vector<Piece>& pieces);

}  // namespace shadowcache
