#pragma once

#include <fmt/core.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/benchmarks/bench.h"
#include "tests/benchmarks/deviation.h"

namespace shadowcache::bench {

/// Camera rays of a pixel and samples of each.
struct Split {
    int cameraRays, samples;

    std::string name() const { return fmt::format("{}x{}", cameraRays, samples); }
    int rays() const { return cameraRays * samples; }
    bool operator==(const Split&) const = default;
};

/// "16x4". @throws Error for anything else
Split parseSplit(const std::string& text);

/// What is looked at of a frame.
struct View {
    const char* name;
    RenderOptions options;
};

/// All of a picture of 320x180.
View wholeView();

/// Error and cost of an antialiased picture: means over seeds, the least time.
struct Measured {
    RelativeError error;
    double seconds = 0;          ///< of the processor, over the threads
    double own = 0, reused = 0;  ///< shadow rays a pixel
    Deviation fromReference, fromBrighter;
    double efficiency() const { return 1 / (error.mean * seconds); }
    double efficiencyOfP99() const { return 1 / (error.p99 * seconds); }
};

/// A frame and what it should look like.
struct Picture {
    const Frame& frame;
    const View& view;
    const Image& reference;
    int seeds;

    std::string key(const Split& split, const std::string& estimator) const {
        return frame.key() + "." + view.name + "." + split.name() + "." + estimator;
    }
};

Measured measure(const Picture& picture, const Split& split, const std::string& estimator);

/// `mis` at every split of so many rays: a power of 4 less samples with each, or what is left.
std::vector<std::pair<Split, Measured>> measureMis(const Picture& picture, int rays);

/// 8 samples for each of 1,024 camera rays; an earlier run's, if one left it in `work`.
Reference antialiasedReference(const Frame& frame, const View& view,
                               const std::filesystem::path& work);

}  // namespace shadowcache::bench
