#include "bake/core/voxel_selection.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace shadowcache {

namespace {

/// Angle between two unit vectors; rounding does not matter beside kSlack.
float angleBetween(const Vec3f& a, const Vec3f& b) {
    return std::acos(std::clamp(a.dot(b), -1.0f, 1.0f));
}

/// For rounding.
constexpr float kSlack = 1e-3f;

/// Largest angle between a patch's normal and that of a patch that it may be cut into.
float spreadOf(const Patch& patch, double spacing) {
    if (!maySubdivide(patch, spacing)) return 0;
    float spread = 0;
    for (const Piece& piece : patch.pieces)
        spread = std::max(spread, angleBetween(piece.normal, patch.normal));
    return spread;
}

/// Whether a lookup with a normal of the set can find an item with a normal at most `spread` from
/// `normal`.
bool canFind(const NormalSet& lookups, const Vec3f& normal, float spread) {
    struct Cap {
        Vec3f axis;
        float angle;
    };
    static const auto kCaps = [] {
        std::array<Cap, cellCount(kNormalLevel)> caps;
        for (std::uint32_t c = 0; c < caps.size(); ++c) {
            const CellCap cap = cellCap(kNormalLevel, c);
            caps[c] = {Vec3f(cap.axis), static_cast<float>(cap.angle)};
        }
        return caps;
    }();
    static const float kReach = std::acos(kMinAgreement) + kSlack;
    for (std::uint32_t c = 0; c < kCaps.size(); ++c)
        if (lookups.test(c) &&
            angleBetween(kCaps[c].axis, normal) < kReach + kCaps[c].angle + spread)
            return true;
    return false;
}

}  // namespace

void VoxelLookups::add(const VoxelLookups& more) {
    for (const auto& [key, normals] : more.voxels_) voxels_[key] |= normals;
}

VoxelLookups VoxelLookups::dilated(const VoxelFrame& frame, int margin) const {
    if (margin == 0) return *this;
    VoxelLookups out;
    for (const auto& [key, normals] : voxels_) {
        const Vec3i center = frame.voxel(key);
        for (int x = -margin; x <= margin; ++x)
            for (int y = -margin; y <= margin; ++y)
                for (int z = -margin; z <= margin; ++z)
                    if (const Vec3i voxel = center + Vec3i(x, y, z); frame.holds(voxel))
                        out.voxels_[frame.key(voxel)] |= normals;
    }
    return out;
}

const NormalSet* VoxelLookups::find(std::uint64_t voxelKey) const {
    const auto found = voxels_.find(voxelKey);
    return found == voxels_.end() ? nullptr : &found->second;
}

VoxelSides::VoxelSides(const VoxelFrame& frame, const CacheItems& items) {
    for (std::size_t i = 0; i < items.size(); ++i)
        add(frame.key(items.voxel[i]), PatchCode::of(items.patch[i]).side);
}

bool VoxelSides::contains(std::uint64_t voxelKey, int side) const {
    const auto found = voxels_.find(voxelKey);
    return found != voxels_.end() && (found->second >> side & 1) != 0;
}

std::size_t VoxelSides::sides() const {
    std::size_t sum = 0;
    for (const auto& [key, sides] : voxels_) sum += static_cast<std::size_t>(std::popcount(sides));
    return sum;
}

bool VoxelSelection::wants(std::uint64_t voxelKey, std::span<const Patch> patches,
                           double spacing) const {
    if (present.contains(voxelKey, patches.front().code.side)) return false;
    if (!lookups) return true;
    const NormalSet* normals = lookups->find(voxelKey);
    return normals && std::ranges::any_of(patches, [&](const Patch& patch) {
               return canFind(*normals, patch.normal, spreadOf(patch, spacing));
           });
}

}  // namespace shadowcache
