#include "render/frame/options.h"

#include <cstdint>
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

}  // namespace shadowcache
