#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/trace/scene.h"
#include "render/bounces/path_vertex.h"
#include "render/estimators/estimator.h"

namespace shadowcache {

/// Has those vertices that diffuse rays of a group met, and that are smooth, mirror the sky to the
/// whole group.
void shareMirroredSky(const EstimatorContext& context, PathVertices& met);

/// What vertices mirror of the sky toward places that see them, by one ray for some such pairs:
/// of the map or of the lobe, each with the chance 1/2, weighted by the balance heuristic. A smooth
/// surface mirrors another part of the sky to each of them.
class MirroredSky {
public:
    /// @param context  outlives this object
    explicit MirroredSky(const EstimatorContext& context) : context_(context) {}

    /// Adds what `vertex` mirrors toward `place`, times a factor.
    ///
    /// @param lobe    of the vertex, toward where it was met from
    /// @param member  number of the place in its group: the sum that it is added to
    void add(const PathVertex& vertex, const GlossyLobe& lobe, const Vec3f& place,
             std::uint32_t member, const Rgb& factor, std::span<Rgb> sums);
    /// Adds what still waits for its ray.
    void finish(std::span<Rgb> sums);

    std::uint64_t rays() const { return rays_; }

private:
    const EstimatorContext& context_;
    RayPacket packet_{};
    Vec3f origins_[RayPacket::kSize], directions_[RayPacket::kSize];
    Rgb values_[RayPacket::kSize];
    std::uint32_t members_[RayPacket::kSize] = {};
    int queued_ = 0;
    std::uint64_t rays_ = 0;
};

}  // namespace shadowcache
