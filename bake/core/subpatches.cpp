#include "bake/core/subpatches.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/tuned.h"

namespace shadowcache {

namespace {

/// Subpatches differ where one of them sees this share more or less light than their mean.
SHADOWCACHE_TUNED(float, kLeastChange, 0.1f);
/// And where chance does not explain the difference, by so many standard deviations.
SHADOWCACHE_TUNED(float, kChangeErrors, 1);
/// Rays of one octet start at one point, and so often agree: they count as a third of their number.
SHADOWCACHE_TUNED(float, kRaysAlike, 3);

/// Least area of a subpatch, in areas of the largest, if their rays are to count together.
constexpr float kAlike = 0.7f;

}  // namespace

bool seeDifferentSky(const Subdivision& subdivision, const BaseCells& base) {
    const std::vector<Patch>& subpatches = subdivision.patches;
    const std::vector<Probe>& probes = subdivision.probes;
    if (probes.size() < 2) return false;
    Vec3f normal(0, 0, 0);
    for (const Probe& q : probes) normal += q.normal;
    normal.normalize();
    // Irradiance under a constant sky, which stands for any environment.
    std::vector<float> light(probes.size(), 0);
    float all = 0, rays = 0;
    for (std::size_t c = 0; c < base.axis.size(); ++c) {
        const float cosine = normal.dot(base.axis[c]);
        const auto counted = [c](const Probe& q) { return q.counts[c].rays() > 0; };
        if (cosine <= 0 || !std::all_of(probes.begin(), probes.end(), counted)) continue;
        for (std::size_t k = 0; k < probes.size(); ++k) {
            const Count& count = probes[k].counts[c];
            light[k] +=
                cosine * static_cast<float>(count.visible()) / static_cast<float>(count.rays());
            rays += static_cast<float>(count.rays());
        }
        all += cosine;
    }
    float mean = 0, area = 0;
    for (std::size_t k = 0; k < probes.size(); ++k) {
        mean += light[k] * subpatches[k].area;
        area += subpatches[k].area;
    }
    mean /= area;
    const float skyVisibility = mean / std::max(all, 1e-30f);
    const float chance =
        kChangeErrors * std::sqrt(skyVisibility * kRaysAlike * static_cast<float>(light.size()) /
                                  std::max(rays, 1.0f));
    const float least = all * (kLeastChange * skyVisibility + chance);
    return std::any_of(light.begin(), light.end(),
                       [&](float l) { return std::abs(l - mean) > least; });
}

bool areAlikeInSize(std::span<const Patch> subpatches) {
    if (subpatches.size() < 4) return false;
    const auto [least, most] =
        std::minmax_element(subpatches.begin(), subpatches.end(),
                            [](const Patch& a, const Patch& b) { return a.area < b.area; });
    return least->area > kAlike * most->area;
}

}  // namespace shadowcache
