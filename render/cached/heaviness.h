#pragma once

#include <array>
#include <cstddef>

#include "render/regions/region_shares.h"

namespace shadowcache {

/// Least part of the irradiance from which on a sample is heavy enough to be reused: what its rays
/// to the neighbours cost is then well spent.
inline SHADOWCACHE_TUNED(double, kHeavy, 0.045);

/// Predicted variance of samples by their heaviness: what one that contradicts the prediction
/// contributes, as a part of its place's brightness.
class VarianceByHeaviness {
public:
    /// @param ifReused  what is left of the variance where samples are reused
    void add(double heaviness, double variance, double ifReused);

    /// Adds `share` of another, whose samples are `factor` times as heavy and vary as much more.
    void add(const VarianceByHeaviness& other, double factor, double share);

    /// Heaviness from which on the samples of a frame are reused: a part of the standard deviation
    /// that they and all else leave to a pixel, and kHeavy or more.
    ///
    /// @param cameraRayError  relMSE that no sample makes
    double heavyFrom(double cameraRayError) const;

private:
    static constexpr std::size_t kBins = 128;
    std::array<double, kBins> variance_{}, ifReused_{};  ///< four bins an octave
};

/// That of one sample at a place. Variances are relative, as in relMSE.
///
/// @param scale  irradiance that errors are relative to [luminance]
VarianceByHeaviness varianceByHeaviness(const Regions& regions, const ShareRules& rules,
                                        const Brightness& brightness, double scale);

}  // namespace shadowcache
