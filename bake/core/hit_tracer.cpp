#include "bake/core/hit_tracer.h"

#include <algorithm>
#include <array>

#include "common/cache/cache_items.h"
#include "common/cache/hit_code.h"
#include "common/mesh/placed_mesh.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

/// How far from the point of the ray that is nearest to the hit a stored hit may lie, in spacings.
constexpr double kMostShift = 0.5;

/// An origin of the patch that sees into a direction: that of stratum `stratum` or, if that one
/// lies on a part of the surface that is turned away, the next. -1: none does.
int originTowards(const Patch& patch, const Vec3f& direction, std::size_t stratum) {
    for (std::size_t i = 0; i < Patch::kOrigins; ++i) {
        const std::size_t origin = (stratum + i) % Patch::kOrigins;
        if (patch.originNormal[origin].dot(direction) > 0) return static_cast<int>(origin);
    }
    return -1;
}

/// A hit as readers find it again: on the ray from the patch's mean point, which runs beside the
/// one that was traced. The place is in the plane of the surface, so that no other layer is nearer,
/// but not far from the hit where the ray grazes that plane.
///
/// @param way  from the patch's mean point to the hit, in spacings
std::uint16_t codeOf(const Hit& hit, const Vec3d& way, const Vec3f& direction) {
    const Vec3d d(direction), normal(hit.normal);
    const double across = normal.dot(d), nearest = way.dot(d);
    if (across > 0 && !isDoubleSided(hit.scene->mesh(), hit.triangle)) return HitCode::kSky;
    const int front = sideOf(hit.normal);
    const double inPlane = across != 0 ? way.dot(normal) / across : nearest;
    return HitCode::of(std::clamp(inPlane, nearest - kMostShift, nearest + kMostShift),
                       across > 0 ? front ^ 1 : front);
}

}  // namespace

std::uint64_t traceHits(const Scene& scene, const VoxelFrame& frame, const Vec3i& voxel,
                        const Patch& patch, std::vector<std::uint16_t>& out) {
    const HitRays ways(voxel, patch.code.packed(), patch.normal, kHitRays);
    const Vec3d middle = frame.center(voxel);
    const std::uint64_t h = hashWords(patch.seed, BakeSalt::hitOrigins);
    // Neighbouring rays start far from each other: the step has no factor in common with 64.
    constexpr std::size_t kStep = 27;
    std::uint64_t traced = 0;
    for (int first = 0; first < kHitRays; first += RayPacket::kSize) {
        RayPacket rays{};
        std::array<int, RayPacket::kSize> rayOf{};
        std::array<std::uint16_t, RayPacket::kSize> codes;
        codes.fill(HitCode::kUnknown);
        int count = 0;
        for (int k = 0; k < RayPacket::kSize; ++k) {
            const Vec3f direction = ways.direction(first + k);
            const int origin =
                originTowards(patch, direction,
                              (h + static_cast<std::size_t>(first + k) * kStep) % Patch::kOrigins);
            if (origin < 0) continue;
            rays.set(count, patch.origin[static_cast<std::size_t>(origin)], direction);
            rayOf[static_cast<std::size_t>(count++)] = k;
        }
        std::array<Hit, RayPacket::kSize> hits;
        if (count > 0) scene.meet(rays, count, hits.data());
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            const Hit& hit = hits[i];
            const auto k = static_cast<std::size_t>(rayOf[i]);
            const Vec3d way =
                (Vec3d(hit.position) - middle) / frame.spacing() - Vec3d(patch.meanPosition);
            codes[k] =
                hit.found ? codeOf(hit, way, ways.direction(first + rayOf[i])) : HitCode::kSky;
        }
        out.insert(out.end(), codes.begin(), codes.end());
        traced += static_cast<std::uint64_t>(count);
    }
    return traced;
}

}  // namespace shadowcache
