#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <span>
#include <vector>

#include "bake/core/depth_layers.h"
#include "bake/core/placement.h"
#include "common/cache/patch_code.h"
#include "common/trace/scene.h"

namespace shadowcache {

/// Bit s stands for side s of PatchCode.
using SideSet = std::bitset<kSides>;

/// Where the rays of one item start: many points spread evenly over one side of the surface in a
/// voxel, over one depth layer of it, or over a subpatch.
struct Patch {
    static constexpr int kOrigins = 64;

    PatchCode code;
    std::uint64_t seed = 0;              ///< of its origins and rays
    Box box;                             ///< the voxel, or the subpatch's box in it
    float area = 0;                      ///< of the surface in it
    std::vector<Piece> pieces;           ///< parts of the surface in it
    Vec3f normal;                        ///< unit mean normal, by area
    Vec3f meanPosition;                  ///< relative to the voxel's centre, in spacings
    float minAgreement = 1;              ///< least cosine between `normal` and an origin's normal
    std::array<Vec3f, kOrigins> origin;  ///< moved off the surface, relative to the mesh's origin
    std::array<Vec3f, kOrigins> originNormal;  ///< unit, to the patch's side
};

/// The patches of a voxel's sides and their depth layers, in the order of their codes. `fragments`
/// are those of one voxel.
///
/// @param seed  decides where on the surface the origins lie
/// @param only  sides to make patches of; each patch is as with all sides
std::vector<Patch> makePatches(const Scene& scene, const VoxelFrame& frame,
                               std::span<const Fragment> fragments, std::uint64_t seed,
                               const SideSet& only = SideSet().set());

/// Whether a patch may be cut: it is one flat surface, neither small nor cut too often.
bool maySubdivide(const Patch& patch, double spacing);

/// The subpatches of a patch of the voxel with the middle `voxelCenter` that hold any surface, in
/// the order of their codes. None where the patch may not be cut.
std::vector<Patch> makeSubpatches(const Scene& scene, const Vec3d& voxelCenter, double spacing,
                                  const Patch& patch);

}  // namespace shadowcache
