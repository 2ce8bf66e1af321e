#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "common/cache/patch_code.h"
#include "common/math/vec.h"

namespace shadowcache {

/// Least cosine between the normals of a place and of an item that counts there: up to 60 degrees,
/// the closer the more.
inline constexpr float kMinAgreement = 0.5f;

/// Inverse of the distance from the plane of an item, in spacings, at which it counts a third.
inline constexpr float kPlaneFalloff = 5;

/// Least weight of an item, as a share of the weights of all items of a lookup.
inline constexpr float kLeastItemShare = 0.03f;

/// Cosine between the normals of a place and of an item, above the least that counts; 0 or below:
/// the item does not count.
inline float agreementOf(const Vec3f& itemNormal, const Vec3f& normal) {
    return itemNormal.dot(normal) - kMinAgreement;
}

/// Weight of a whole layer by its voxel's trilinear weight. The small addend keeps a lone item in a
/// far corner from losing its weight altogether.
inline float nearOf(double trilinear) {
    return static_cast<float>(trilinear) + 1e-6f;
}

/// Weight of a subpatch at a place, by the place's distance from the subpatch's middle along the
/// patch: bilinear among subpatches of one size. Outside of its voxel it falls to zero across the
/// patch, too. `fromMiddle`: of the voxel, in spacings.
inline float partWeight(const PatchCode& code, const Vec3f& fromMiddle) {
    const std::array<float, 2> middle = middleOf(code.subpatch);
    const auto inverse = static_cast<float>(1 << subdivisionsOf(code.subpatch));
    float weight = std::clamp(2 - 2 * std::abs(fromMiddle[code.side / 2]), 0.0f, 1.0f);
    for (int k = 0; k < 2; ++k) {
        const int axis = (code.side / 2 + 1 + k) % 3;
        const float away =
            std::abs(fromMiddle[axis] - middle[static_cast<std::size_t>(k)]) * inverse;
        weight *= std::max(0.0f, 1 - away);
    }
    return weight;
}

/// Weight of an item in a lookup.
///
/// @param near       by its place in the voxel's neighbourhood
/// @param agreement  agreementOf(), above 0
/// @param toItem     from the place to the item's mean point, in spacings
/// @param normal     unit, of the place
inline float itemWeight(float near, float agreement, const Vec3f& toItem, const Vec3f& normal) {
    // Another layer of surface a little above or below sees other things.
    const float plane = kPlaneFalloff * toItem.dot(normal);
    const float nearness = 1 / (1 + plane * plane * (1 + plane * plane));
    return near * std::min(1.0f, agreement / (1 - kMinAgreement)) * nearness;
}

}  // namespace shadowcache
