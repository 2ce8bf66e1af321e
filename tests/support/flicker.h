#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "common/shot/camera.h"
#include "render/frame/integrator.h"
#include "render/table/estimator_table.h"

namespace shadowcache::test {

// How much the places of a static set flicker over the frames of a shot.

/// Frames of one shot by one estimator: the luminance of each pixel's irradiance.
using ShotLight = std::vector<std::vector<double>>;

/// Renders a frame for each camera, with `numbers` in the frames' seeds; `stats` adds up.
ShotLight renderShot(const EstimatorContext& context, const std::string& estimator,
                     std::span<const Camera> cameras, std::span<const int> numbers,
                     const RenderOptions& options, RenderStats& stats,
                     const EstimatorOptions& estimatorOptions = {});

/// Places of the set that all frames see, by frame: the pixel that sees each.
struct Places {
    std::vector<std::vector<std::size_t>> pixels;

    std::size_t count() const { return pixels.front().size(); }
};
/// Places that the pixels of the first frame look at.
Places trackPlaces(const EstimatorContext& context, std::span<const Camera> cameras,
                   const RenderOptions& options);

/// The same pixels in all frames, as places: shows noise that sticks to the screen.
Places samePixels(const Places& places);

/// What a place's light is measured by: its mean over the frames, but no less than a tenth of the
/// whole set's.
std::vector<double> brightness(const ShotLight& reference, const Places& places);

/// Errors of a shot, pixel by pixel.
ShotLight errorsOf(const ShotLight& shot, const ShotLight& reference);

/// Variance of a place's light over the frames, in its brightness; mean over the places.
double temporalVariance(const ShotLight& shot, const Places& places,
                        std::span<const double> brightness);

/// Correlation of each frame's errors with those of the next, place by place. Noise of which each
/// frame has its own gives 0 on average.
std::vector<double> correlations(const ShotLight& errors, const Places& places,
                                 std::span<const double> brightness);

}  // namespace shadowcache::test
