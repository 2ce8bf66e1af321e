#pragma once

#include <optional>

#include "render/frame/options.h"
#include "render/table/estimator_table.h"

namespace shadowcache {

/// Above 0, which no number of rays reaches: the rounding of floats, squared.
inline constexpr double kLeastTargetError = 1e-14;

/// The rays that are asked for of a pixel.
struct PixelRays {
    std::optional<int> spp;                  ///< shadow rays, one of each camera ray
    std::optional<int> cameraRays, samples;  ///< in place of `spp`: shadow rays of each camera ray
    bool preview = false;                    ///< RenderOptions::preview
    /// In place of `spp` and `cameraRays`: relMSE that planForError() chooses camera rays for.
    std::optional<double> targetError{};
};

/// Fills in camera rays, samples and preview. Where nothing is asked for, the rays are those of a
/// picture to deliver, or of a preview.
///
/// @throws Error if they are out of range, or the estimator has no preview
void chooseRays(const PixelRays& rays, const EstimatorEntry& estimator, RenderOptions& options);

/// Refuses what an estimator cannot render.
///
/// @throws Error naming the option and the value wanted
void requireFit(const EstimatorEntry& estimator, bool hasCache, const RenderOptions& options);

}  // namespace shadowcache
