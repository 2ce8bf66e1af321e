#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "bake/placement.h"
#include "common/scene.h"

namespace shadowcache {

/// Where the rays of one item start: many points spread evenly over one side of the surface in a
/// voxel, or over one layer of it.
struct Patch {
    static constexpr int kOrigins = 64;

    int side = 0;                        ///< as CacheItems::side
    Vec3f normal;                        ///< unit mean normal, by area
    Vec3f meanPosition;                  ///< relative to the voxel's centre, in spacings
    float minAgreement = 1;              ///< least cosine between `normal` and an origin's normal
    std::array<Vec3f, kOrigins> origin;  ///< moved off the surface, relative to the mesh's origin
    std::array<Vec3f, kOrigins> originNormal;  ///< unit, to the patch's side
};

/// The patches of a voxel's sides and their layers, in the order of Patch::side. `fragments` are
/// those of one voxel.
///
/// @param seed decides where on the surface the origins lie
std::vector<Patch> makePatches(const Scene& scene, const VoxelFrame& frame,
                               std::span<const Fragment> fragments, std::uint64_t seed);

}  // namespace shadowcache
