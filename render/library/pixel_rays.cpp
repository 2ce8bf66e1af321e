#include "render/library/pixel_rays.h"

#include <algorithm>
#include <string>

#include "common/base/error.h"
#include "common/base/option_checks.h"

namespace shadowcache {

namespace {

/// Shadow rays of a pixel: of a picture that is delivered, and of a preview.
constexpr int kStandardRays = 64;
constexpr int kPreviewRays = 4;

/// Samples of a camera ray where a target error chooses the camera rays.
constexpr int kTargetErrorSamples = 4;

}  // namespace

void chooseRays(const PixelRays& rays, const EstimatorEntry& estimator, RenderOptions& options) {
    if (rays.targetError) {
        requireRange("target-error", *rays.targetError, kLeastTargetError, 1e6);
        options.cameraRays = 1;
        options.samples = rays.samples.value_or(kTargetErrorSamples);
    } else if (rays.samples || rays.cameraRays) {
        options.cameraRays = rays.cameraRays.value_or(1);
        options.samples = rays.samples.value_or(1);
    } else {
        const int spp = rays.spp.value_or(rays.preview ? kPreviewRays : kStandardRays);
        requireRange("spp", spp, rays.preview ? 0 : 1, kMostCameraRays);
        options.cameraRays = std::max(1, spp);
        options.samples = std::min(1, spp);
    }
    // Without samples the prediction remains, and nothing to filter.
    options.preview = rays.preview && options.samples > 0;
    if (const std::string name = estimator.name; rays.preview && name != "cache")
        throw Error("--preview: expected --estimator cache, found " + name);
}

void requireFit(const EstimatorEntry& estimator, bool hasCache, const RenderOptions& options) {
    const std::string name = estimator.name;
    if (estimator.needsCache && !hasCache)
        throw Error("--estimator " + name +
                    " requires --cache: bake the set with shadowcache-bake first");
    if (options.samples < estimator.minSamples)
        throw Error("--samples " + std::to_string(options.samples) + ": --estimator " + name +
                    " expected at least " + std::to_string(estimator.minSamples));
}

}  // namespace shadowcache
