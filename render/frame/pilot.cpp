#include <chrono>
#include <vector>

#include "common/base/hash.h"
#include "common/base/salts.h"
#include "render/frame/tile_renderer.h"

namespace shadowcache {

namespace {

/// Places of the frame that a pilot looks at.
constexpr int kPilotPlaces = 1024;

}  // namespace

void runPilot(const FrameRequest& frame, RenderStats& stats) {
    const RenderOptions& options = frame.options;
    FramePilot* pilot = frame.estimator.pilot();
    if (options.samples == 0 || !pilot) return;
    const auto start = std::chrono::steady_clock::now();
    const TileRenderer renderer(frame);
    std::vector<ShadingPoint> points;
    for (int k = 0; k < kPilotPlaces; ++k) {
        // The numbers of a pilot belong to no pixel.
        const std::uint64_t seed = pixelSeed(options.seed, frame.number, -1, -1, k);
        const double u = toUnit(hashWords(seed, FrameSalt::pilotColumn)),
                     v = toUnit(hashWords(seed, FrameSalt::pilotRow));
        const View view = renderer.look(u, v);
        if (view.hit.found)
            points.push_back(renderer.shadingPoint(view, seed, static_cast<int>(u * options.width),
                                                   static_cast<int>(v * options.height)));
    }
    stats.shadowRays += pilot->run(points, options.samples);
    stats.cameraRays += kPilotPlaces;
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    stats.seconds += seconds;
    stats.setupSeconds += seconds;
}

}  // namespace shadowcache
