#include "tests/benchmarks/antialiased.h"

#include <algorithm>
#include <cstdio>

#include "common/base/error.h"

namespace shadowcache::bench {

namespace {

/// Of each half of a reference, which then has 1024 x 8. Few camera rays of a pixel meet a narrow
/// gap with a lamp behind: a picture that meets one which the reference misses has a huge error.
constexpr Split kReferenceSplit{512, 8};

/// The control: a reference so much brighter must be told from the true one.
constexpr double kControl = 1.02;

/// All splits of as many rays: a power of 4 less samples with each, or what is left.
std::vector<Split> splitsOf(int rays) {
    std::vector<Split> splits;
    for (int cameraRays = rays; cameraRays > 1; cameraRays = (cameraRays + 3) / 4)
        if (rays % cameraRays == 0) splits.push_back({cameraRays, rays / cameraRays});
    splits.push_back({1, rays});
    return splits;
}

}  // namespace

Split parseSplit(const std::string& text) {
    Split split{0, 0};
    char rest = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &split.cameraRays, &split.samples, &rest) != 2 ||
        split.cameraRays < 1 || split.samples < 1)
        throw Error("--splits " + text + ": wanted KxN, as in 16x4");
    return split;
}

View wholeView() {
    View view{"whole", {}};
    view.options.width = 320;
    view.options.height = 180;
    return view;
}

Measured measure(const Picture& picture, const Split& split, const std::string& estimator) {
    Measured m;
    RenderOptions options = picture.view.options;
    options.cameraRays = split.cameraRays;
    options.samples = split.samples;
    const double share = 1.0 / picture.seeds;
    for (int i = 0; i < picture.seeds; ++i) {
        options.seed = static_cast<std::uint64_t>(i) + 1;
        const Rendered r = renderWith(picture.frame.context, picture.frame.set, estimator,
                                      picture.frame.number, options);
        const RelativeError e = relativeError(r.image, picture.reference);
        m.error.mean += e.mean * share;
        m.error.p99 += e.p99 * share;
        m.error.max = std::max(m.error.max, e.max);
        m.seconds = i == 0 ? r.processorSeconds : std::min(m.seconds, r.processorSeconds);
        const double pixels = static_cast<double>(r.image.pixels.size()) / share;
        m.own += static_cast<double>(r.stats.shadowRays - r.stats.reusedRays) / pixels;
        m.reused += static_cast<double>(r.stats.reusedRays) / pixels;
        m.fromReference.add(r.image, picture.reference, 1);
        m.fromBrighter.add(r.image, picture.reference, kControl);
    }
    return m;
}

std::vector<std::pair<Split, Measured>> measureMis(const Picture& picture, int rays) {
    std::vector<std::pair<Split, Measured>> found;
    for (const Split& split : splitsOf(rays))
        found.emplace_back(split, measure(picture, split, "mis"));
    return found;
}

Reference antialiasedReference(const Frame& frame, const View& view,
                               const std::filesystem::path& work) {
    RenderOptions options = view.options;
    options.cameraRays = kReferenceSplit.cameraRays;
    options.samples = kReferenceSplit.samples;
    return makeReference(frame.context, frame.set, frame.number, options, work,
                         frame.key() + ".antialiased." + view.name);
}

}  // namespace shadowcache::bench
