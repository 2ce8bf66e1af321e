#pragma once

#include <span>
#include <vector>

#include "common/light/environment.h"

namespace shadowcache {

// Patches of the sky: the cells of a level of the direction mesh, 20 * 4^level over the sphere.

inline constexpr int kCoarsestPatches = 1;
inline constexpr int kFinestPatches = Environment::kLevel;

/// Light of each patch: the integral of the radiance over it [radiance sr].
///
/// @param level  kCoarsestPatches .. kFinestPatches
std::vector<Vec3d> lightOfPatches(const Environment& environment, int level);

/// What a surface receives from patches of even light. Immutable, thread-safe.
class PatchCosines {
public:
    PatchCosines();

    /// Mean over each patch of the cosine to a unit normal, 0 below the horizon: the irradiance by
    /// a patch that nothing hides, for each unit of its light.
    ///
    /// @param out  cellCount(level)
    void at(int level, const Vec3f& normal, std::span<float> out) const;

    /// Solid angle of a patch [sr], as the tables of environments have it.
    float solidAngle(int level, std::uint32_t patch) const {
        return static_cast<float>(white_.luminanceIntegral(level, patch));
    }

private:
    Environment white_;
};

}  // namespace shadowcache
