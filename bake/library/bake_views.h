#pragma once

#include <array>
#include <span>

#include "bake/core/baker.h"
#include "common/shot/camera.h"
#include "common/shot/loaded_set.h"

namespace shadowcache {

/// Pictures that a bake is made for.
struct Views {
    std::span<const CameraMove> cameras;  ///< of a picture each; at least one
    std::array<int, 2> size{960, 540};    ///< of the pictures [pixels], 1 .. 65536
    int margin = 0;  ///< voxels to bake around those that are looked up, 0 .. 64
};

/// Bakes of a set what some pictures look up, where nothing moves. A spacing that is 0 and a level
/// that is not given are chosen by the set and the pictures, as by `shadowcache-bake --camera`.
///
/// @param isLevelGiven  keep the options' level
/// @throws Error on impossible options
BakeResult bakeViews(const LoadedSet& set, BakeOptions options, const Views& views,
                     bool isLevelGiven);

}  // namespace shadowcache
