#include "render/frame/options.h"

#include <cstdint>
#include <sstream>
#include <string>

#include "common/base/error.h"
#include "common/base/option_checks.h"

namespace shadowcache {

// 20 GB of film.
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

void validate(const RenderOptions& options) {
    requireRange("size (width)", options.width, 1, 65536);
    requireRange("size (height)", options.height, 1, 65536);
    if (std::int64_t{options.width} * options.height > kMaxPixels)
        throw Error("--size " + std::to_string(options.width) + "x" +
                    std::to_string(options.height) + ": wanted at most " +
                    std::to_string(kMaxPixels) + " pixels");
    requireRange("samples", options.samples, 0, kMostSamples);
    requireRange("camera-rays", options.cameraRays, 1, 65536);
    for (int k = 0; k < 3; ++k) requireRange("albedo", options.albedo[k], 0.0f, 1.0f);
}

void validate(const EstimatorOptions& options) {
    requireRange("triangles", options.triangles, 20, 100000);
    requireRange("max-level", options.maxLevel, 0, 7);
    requireRange("min-level", options.minLevel, 0, options.maxLevel);
    requireRange("threshold", options.threshold, 0, 1000);
    requireRange("order", options.order, 0, 1);
    requireRange("beta", options.beta, 0.0, 1.0);
    requireRange("cache-level", options.cacheLevel, 0, 7);
    requireRange("lights", options.lights, 1, 10000);
    requireRange("pixel-map (width)", options.pixelWidth, 8, 4096);
    requireRange("pixel-map (height)", options.pixelHeight, 4, 2048);
    if (!(options.alpha >= 0 && options.alpha < 1)) {
        std::ostringstream text;
        text << "--alpha " << options.alpha
             << ": wanted 0 or more and below 1 (at 1 a cached 0 would never be sampled: biased)";
        throw Error(text.str());
    }
}

}  // namespace shadowcache
