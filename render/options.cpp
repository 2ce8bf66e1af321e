#include "render/options.h"

#include <cmath>
#include <sstream>

#include "common/error.h"

namespace shadowcache {

namespace {

template <class T>
void requireRange(const char* name, T value, T least, T most) {
    if (value >= least && value <= most) return;
    std::ostringstream text;
    text << "--" << name << ' ' << value << ": wanted " << least << " to " << most;
    throw Error(text.str());
}

}  // namespace

void validate(const RenderOptions& options) {
    requireRange("size (width)", options.width, 1, 65536);
    requireRange("size (height)", options.height, 1, 65536);
    requireRange("samples", options.samples, 0, 1 << 20);
    requireRange("camera-rays", options.cameraRays, 1, 65536);
    for (int k = 0; k < 3; ++k) requireRange("albedo", options.albedo[k], 0.0f, 1.0f);
}

void validate(const EstimatorOptions& options) {
    requireRange("triangles", options.triangles, 20, 100000);
    requireRange("min-level", options.minLevel, 0, 7);
    requireRange("max-level", options.maxLevel, options.minLevel, 7);
    requireRange("threshold", options.threshold, 0, 1000);
    if (!(options.alpha >= 0 && options.alpha < 1)) {
        std::ostringstream text;
        text << "--alpha " << options.alpha
             << ": wanted 0 or more and below 1 (at 1 a cached 0 would never be sampled: biased)";
        throw Error(text.str());
    }
}

}  // namespace shadowcache
