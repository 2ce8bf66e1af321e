#pragma once

#include <array>
#include <span>

#include "bake/core/voxel_selection.h"
#include "common/shot/camera_source.h"
#include "common/shot/moving_set.h"

namespace shadowcache {

/// A shot that a bake is made for.
struct Shot {
    const CameraSource& camera;
    MovingSet& moving;  ///< lit with the cache, but no part of it
    std::span<const int> frames;
    std::array<int, 2> size;  ///< of its pictures [pixels]
};

/// Places at which the pictures of a shot look a cache up: what camera rays meet. A sample of the
/// rays finds them, more of them until new ones meet next to nothing new. Frames are looked at one
/// by one, so the places of two shots together are those of both.
///
/// @param scene  has nothing that moves, before and after
/// @throws Error if the camera has no such frame
LookupPlaces lookupsOf(const Shot& shot, Scene& scene, const VoxelFrame& frame);

/// The same of one picture, with what the scene has now.
///
/// @param size  [pixels]
LookupPlaces lookupsOf(const CameraMove& camera, const Scene& scene, const VoxelFrame& frame,
                       std::array<int, 2> size);

}  // namespace shadowcache
