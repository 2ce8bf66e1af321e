#include "render/bounces/mirrored_sky.h"

#include "common/base/hash.h"
#include "common/base/tuned.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

/// Width of a lobe up to which a vertex mirrors the sky to its whole group. Wider ones have little
/// noise of their own, and mirror about the same to all.
SHADOWCACHE_TUNED(float, kSharedAlpha, 0.1f);

/// Of so many members of a group that see a vertex, one takes part, at random.
SHADOWCACHE_TUNED(std::uint32_t, kMirrorEvery, 4);

}  // namespace

void shareMirroredSky(const EstimatorContext& context, PathVertices& met) {
    if (!(context.environment.luminanceIntegral() > 0)) return;
    for (PathVertex& v : met.vertices)
        v.sharesMirroredSky =
            v.isGlossy() && v.throughLobe == Rgb(0, 0, 0) && met.lobeOf(v).alpha() <= kSharedAlpha;
}

void MirroredSky::add(const PathVertex& vertex, const GlossyLobe& lobe, const Vec3f& place,
                      std::uint32_t member, const Rgb& factor, std::span<Rgb> sums) {
    const std::uint64_t turn = hashWords(vertex.seed, RenderSalt::mirroredSkyTurn);
    if ((member + turn) % kMirrorEvery != 0) return;
    const Vec3f way = place - vertex.target;
    const float length = way.length();
    if (!(length > 0)) return;
    const GlossyLobe toPlace = lobe.seenFrom(vertex.normal, way / length);
    const std::uint64_t seed = hashWords(vertex.seed, RenderSalt::mirroredSky, member);
    const auto number = [&](std::uint64_t dimension) { return toUnit(hashWords(seed, dimension)); };
    const auto at = [&](std::uint64_t dimension) {
        return static_cast<float>(number(dimension)) * 0x1.fffffep-1f;
    };
    const EnvironmentSample s = number(0) < 0.5
                                    ? context_.environment.sample(number(1), at(2), at(3))
                                    : context_.environment.lookUp(toPlace.sample(at(2), at(3)));
    const float density = 0.5f * (s.density + toPlace.density(s.direction));
    if (!(density > 0) || !(s.direction.dot(vertex.geometricNormal) > 0)) return;
    const Rgb value = s.radiance * toPlace.value(s.direction) * factor *
                      (static_cast<float>(kMirrorEvery) / density);
    if (value == Rgb(0, 0, 0)) return;
    packet_.set(queued_, vertex.origin, s.direction);
    origins_[queued_] = vertex.origin;
    directions_[queued_] = s.direction;
    values_[queued_] = value;
    members_[queued_] = member;
    if (++queued_ == RayPacket::kSize) finish(sums);
}

void MirroredSky::finish(std::span<Rgb> sums) {
    if (queued_ == 0) return;
    const Scene& scene = context_.scene;
    const std::uint32_t visible = scene.visibility(packet_, queued_);
    for (int i = 0; i < queued_; ++i) {
        if ((visible >> i & 1) == 0) continue;
        if (scene.tints()) values_[i] *= scene.tint(origins_[i], directions_[i]);
        sums[members_[i]] += values_[i];
    }
    rays_ += static_cast<std::uint64_t>(queued_);
    queued_ = 0;
}

}  // namespace shadowcache
