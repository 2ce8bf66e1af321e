#include "render/frame/options.h"

#include <fmt/core.h>

#include <cstdint>
#include <string>

#include "common/base/error.h"
#include "common/base/option_checks.h"

namespace shadowcache {

// 33 GB of film.
constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

// Their numbers have 32 bits.
constexpr std::int64_t kMostPixelSamples = std::int64_t{1} << 31;

void validate(const RenderOptions& options) {
    requireRange("size (width)", options.width, 1, 65536);
    requireRange("size (height)", options.height, 1, 65536);
    const std::string size = fmt::format("--size {}x{}", options.width, options.height);
    const FilmRectangle region = options.region();
    const auto& [x, y, width, height] = region;
    if (width < 1 || height < 1 || x < 0 || y < 0 || width > options.width - x ||
        height > options.height - y)
        throw Error(fmt::format("--crop {},{},{}x{}: expected a part of the frame, {}", x, y, width,
                                height, size));
    if (std::int64_t{width} * height > kMaxPixels)
        throw Error(fmt::format("{}: expected at most {} pixels", size, kMaxPixels));
    requireRange("samples", options.samples, 0, kMostSamples);
    requireRange("camera-rays", options.cameraRays, 1, kMostCameraRays);
    if (std::int64_t{options.cameraRays} * options.samples > kMostPixelSamples)
        throw Error(
            fmt::format("--camera-rays {} with --samples {}: wanted at most {} samples a pixel",
                        options.cameraRays, options.samples, kMostPixelSamples));
    requireRange("pass-rays", options.passRays, 1, kMostCameraRays);
    requireRange("clamp-indirect", options.clampIndirect, 0.0f, 1e30f);
    requireRange("filter-width", options.filterWidth, 0.0, 16.0);
    for (int k = 0; k < 3; ++k) requireRange("albedo", options.plain.albedo[k], 0.0f, 1.0f);
    const Gloss gloss = options.plain.gloss.value_or(Gloss{});
    requireRange("material roughness", gloss.roughness, 0.0f, 1.0f);
    requireRange("material metallic", gloss.metallic, 0.0f, 1.0f);
    requireRange("material ior", gloss.ior, 1.0f, 1e6f);
    requireRange("material specular", gloss.specular, 0.0f, 1.0f);
}

}  // namespace shadowcache
