#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/base/hash.h"
#include "common/base/tuned.h"
#include "common/cache/cache_header.h"
#include "common/cache/patch_code.h"
#include "common/math/vec.h"

namespace shadowcache {

/// Directions of the rays of an item whose hits are kept: points of a Hammersley set that is
/// shifted by a hash of the item's place, drawn to the hemisphere by the cosine. They do not depend
/// on the bake's seed, so that hits keep their meaning when caches are merged.
class HitRays {
public:
    /// @param patch   of the item, packed
    /// @param normal  of the item, unit
    /// @param rays    1 to kMostHits
    HitRays(const Vec3i& voxel, std::int16_t patch, const Vec3f& normal, int rays)
        : normal_(normal), rays_(static_cast<float>(rays)) {
        const auto word = [](int v) { return std::uint64_t{static_cast<std::uint32_t>(v)}; };
        const std::uint64_t h =
            hashWords(word(voxel.x) << 32 | word(voxel.y), word(voxel.z), word(patch));
        shift_[0] = toUnitFloat(static_cast<std::uint32_t>(h >> 32));
        shift_[1] = toUnitFloat(static_cast<std::uint32_t>(h));
        tangentFrame(normal, s_, t_);
    }

    /// Unit direction of ray `k`; the first are the steepest.
    Vec3f direction(int k) const {
        const float u = (static_cast<float>(k) + shift_[0]) / rays_;
        float inverse = 0;
        for (int bit = 0; k >> bit; ++bit)
            inverse += k >> bit & 1 ? 0.5f / static_cast<float>(1 << bit) : 0.0f;
        const float phi = 2 * static_cast<float>(kPi) * (inverse + shift_[1]);
        const float sine = std::sqrt(u), cosine = std::sqrt(std::max(0.0f, 1 - u));
        return s_ * (sine * std::cos(phi)) + t_ * (sine * std::sin(phi)) + normal_ * cosine;
    }

private:
    Vec3f normal_, s_, t_;
    float shift_[2], rays_;
};

/// Distance up to which a surface hides another, in spacings: a cupboard's door, a picture on a
/// wall.
inline SHADOWCACHE_TUNED(float, kHiding, 0.3f);

/// What a ray met, as a cache keeps it: 16 bits.
class HitCode {
public:
    /// The ray reached the sky.
    static constexpr std::uint16_t kSky = 0;
    /// Nothing is known: no point of the item's surface sees into the ray's direction.
    static constexpr std::uint16_t kUnknown = 1;

    /// @param distance  of the hit along the ray from the item's mean point, in spacings; 0 to 2^21
    /// @param side      of PatchCode, of the surface that was met, towards the ray
    static std::uint16_t of(double distance, int side) {
        const double step = kSteps * std::log2(1 + std::max(0.0, distance) / kNear);
        const int q = static_cast<int>(std::min(step + 0.5, double{kDistances - 1}));
        return static_cast<std::uint16_t>(kFirst + kSides * q + side);
    }
    static constexpr bool isValid(std::uint16_t code) {
        return code < kFirst + kSides * kDistances;
    }
    static constexpr bool isSurface(std::uint16_t code) { return code >= kFirst; }
    static constexpr int side(std::uint16_t code) { return (code - kFirst) % kSides; }
    /// Whether the ray got away from the surface that it started on: it reached the sky, or what it
    /// met is farther than a surface that hides another.
    static bool isFree(std::uint16_t code) {
        return code == kSky || (isSurface(code) && distance(code) > static_cast<double>(kHiding));
    }
    static double distance(std::uint16_t code) {
        const int step = (code - kFirst) / kSides;
        return kNear * (std::exp2(step / kSteps) - 1);
    }

private:
    static constexpr int kFirst = 2;
    /// As many as 16 bits hold.
    static constexpr int kDistances = (0x10000 - kFirst) / kSides;
    /// Distance up to which steps are about alike, in spacings: nearer hits need no finer ones.
    static constexpr double kNear = 4;
    /// Steps in which 1 + distance / kNear doubles: as many as reach over 2^20 voxels along each
    /// axis. A step is .005 spacings near by, .4 at 300 spacings.
    static constexpr double kSteps = 570;
};

}  // namespace shadowcache
