#pragma once

#include <optional>

#include "bake/core/options.h"
#include "bake/core/voxel_selection.h"

namespace shadowcache {

/// Lookups in voxels of one spacing, as lookups in voxels of another, coarser one.
LookupPlaces inVoxelsOf(const VoxelFrame& coarser, const LookupPlaces& places,
                        const VoxelFrame& frame);

/// How fine the cache of a shot is.
struct ShotResolution {
    double factor;  ///< of the set's own spacing, in [1, 16]
    int level;      ///< finest direction level
};

/// The resolution with which the bake and the pictures of a shot take the least time together: few
/// pictures, or small ones, are not worth the rays of fine voxels. If a bake takes time B s^-2 and
/// pictures of equal error F s^a, the sum is least where the bake takes a/2 of what the pictures
/// take. Measured on small pictures of a court, leaves and rocks a is 0.1 to 0.3.
///
/// @param places  lookups of the shot in voxels of the set's own spacing
/// @param pixels  of all pictures of the shot, times rayFactor()
/// @param level   none: it is chosen, too
ShotResolution resolutionOfShot(const LookupPlaces& places, const VoxelFrame& frame, double pixels,
                                std::optional<int> level = {});

/// Makes spacing and level as coarse as a shot's pictures are worth, and the lookups those of such
/// voxels.
///
/// @param pixels        of all its pictures
/// @param isLevelGiven  the level stays
/// @return whether the spacing changed
bool fitToShot(const TriangleMesh& mesh, double pixels, bool isLevelGiven, BakeOptions& options,
               VoxelFrame& frame, LookupPlaces& places);

}  // namespace shadowcache
