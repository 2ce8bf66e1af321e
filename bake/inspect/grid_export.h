#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/cache/volume_grids.h"

namespace shadowcache {

/// The kinds of grids for --help, one line each with what they hold.
std::string gridKindsHelp();

/// Names of the kinds of grids.
const std::vector<std::string>& gridKinds();

/// A grid asked for with --export-grid [NAME:]KIND[=ARGUMENT].
struct GridRequest {
    std::string name;      ///< of the grid
    std::string kind;      ///< one of gridKinds()
    std::string argument;  ///< behind '=', empty if there is none
};

/// Parses [NAME:]KIND[=ARGUMENT].
///
/// @throws Error naming what was given, and a kind that it may have meant
GridRequest parseGridRequest(const std::string& spec);

/// The grid asked for; of a voxel's items the one counts that sees most of the upper sky.
///
/// @param environmentRotation  of maps about +Y, in degrees, as the renderer's --env-rotate
/// @param runs                 findVoxels(items)
/// @param cache                file of the items; only bounced-irradiance reads it
/// @throws Error for an argument or a map that cannot be read
VolumeGrid makeVolumeGrid(const GridRequest& request, double environmentRotation,
                          const CacheHeader& header, const CacheItems& items, const VoxelRuns& runs,
                          const std::filesystem::path& cache);

/// Writes the grids asked for, over the voxels of the cache, to an OpenVDB file `path`.
///
/// @throws Error as makeVolumeGrid, for two grids of one name, or when it cannot be written
void exportGrids(const std::vector<GridRequest>& requests, double environmentRotation,
                 const CacheHeader& header, const CacheItems& items,
                 const std::filesystem::path& cache, const std::filesystem::path& path);

}  // namespace shadowcache
