#pragma once

namespace shadowcache {

/// How strongly a region's parent counts beside its own rays, in rays.
inline constexpr float kRegionPrior = 0.5f;

/// Posterior mean of the visibility of a region in which `visible` of `rays` rays reached the sky,
/// with the posterior of its parent as the prior. Neither 0 nor 1 unless the prior is.
/// [docs/estimator.md]
template <class T>
T posteriorVisibility(T visible, T rays, T prior) {
    return (visible + static_cast<T>(kRegionPrior) * prior) / (rays + static_cast<T>(kRegionPrior));
}

/// Prior of the base regions: the mean of the visible shares of all of them, `visible` their sum
/// over `counted` regions with rays, and of one more that is half visible. In (0, 1).
template <class T>
T spherePrior(T visible, T counted) {
    return (visible + static_cast<T>(0.5)) / (counted + 1);
}

}  // namespace shadowcache
