#pragma once

#include <string>
#include <vector>

#include "common/cache/volume_grids.h"

namespace shadowcache {

/// What `--export-grid` knows: "openness: what it holds", one line each, for help.
std::string gridKindsHelp();

/// Words that a SPEC may begin with.
const std::vector<std::string>& gridKinds();

/// One grid asked for: a SPEC [NAME:]KIND[=ARGUMENT] taken apart.
struct GridRequest {
    std::string name;      ///< of the grid
    std::string kind;      ///< one of gridKinds()
    std::string argument;  ///< behind '=', empty if there is none
};

/// @throws Error naming the SPEC and the kinds there are
GridRequest parseGridRequest(const std::string& spec);

/// The grid asked for, of the side of each voxel's surfaces that sees most of the sky above.
///
/// @param environmentRotation  degrees that maps are turned by, as the renderer does
/// @throws Error for an argument or a map that cannot be read
VolumeGrid makeVolumeGrid(const GridRequest& request, double environmentRotation,
                          const CacheHeader& header, const CacheItems& items,
                          const VoxelRuns& runs);

/// Writes the grids asked for to an OpenVDB file of their own, over the voxels of the cache.
///
/// @throws Error as makeVolumeGrid, for two grids of one name, or when it cannot be written
void exportGrids(const std::vector<GridRequest>& requests, double environmentRotation,
                 const CacheHeader& header, const CacheItems& items,
                 const std::filesystem::path& path);

}  // namespace shadowcache
