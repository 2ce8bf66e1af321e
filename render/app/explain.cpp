#include "render/app/explain.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/base/parallel.h"
#include "common/base/percent_text.h"
#include "render/app/duration_text.h"
#include "render/app/thumbnail.h"
#include "render/frame/pilot.h"

namespace shadowcache {

namespace {

/// Means over the pixels of the thumbnail that show the set.
struct Means {
    double set = 0;  ///< share of the picture
    double irradiance = 0, variance = 0, expectedVariance = 0;
    double items = 0, regions = 0, misses = 0, rays = 0;
};

Means meansOf(const Film& film, const Environment& environment) {
    Means m;
    for (const Pixel& p : film.pixels) {
        if (p.depth <= 0) continue;
        m.set += 1;
        m.irradiance += static_cast<double>(environment.luminance(p.irradiance));
        m.variance += static_cast<double>(p.variance);
        m.expectedVariance += static_cast<double>(p.expectedNoise * p.expectedNoise);
        m.items += static_cast<double>(p.items);
        m.regions += static_cast<double>(p.regions);
        m.misses += static_cast<double>(p.misses);
        m.rays += static_cast<double>(p.rays);
    }
    for (double* value : {&m.irradiance, &m.variance, &m.expectedVariance, &m.items, &m.regions,
                          &m.misses, &m.rays})
        *value /= std::max(1.0, m.set);
    m.set /= static_cast<double>(film.pixels.size());
    return m;
}

template <class... Values>
std::string line(const char* format, Values... values) {
    char text[400];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

std::string cacheLines(const ShadowCache& cache, const Means& means, bool used) {
    const CacheHeader& header = cache.header();
    std::string text =
        line("cache       %zu items of %g m, %zu blocks of finer regions, level %d%s\n",
             cache.itemCount(), header.spacing, cache.blockCount(), header.level,
             used ? "" : "; this estimator does not say how it reads them");
    if (used)
        text += line(
            "here        %.1f items and %.0f regions a place; %s of the set in view "
            "has no items\n",
            means.items, means.regions, percentText(means.misses, 2).c_str());
    return text;
}

std::string noiseLine(const Means& means, bool predicted, const RenderOptions& options) {
    if (means.set == 0) return "noise       none: the set is not in view\n";
    if (options.samples == 0)
        return "noise       none, but biased: with no rays it shows what the cache "
               "believes\n";
    const double light = std::max(means.irradiance, 1e-30);
    std::string text = line("noise       %s of the mean light, by the samples of a thumbnail",
                            percentText(std::sqrt(means.variance) / light, 2).c_str());
    if (predicted)
        text += line("; %s by the counts alone, without what good strata gain",
                     percentText(std::sqrt(means.expectedVariance) / light, 2).c_str());
    if (options.preview)
        text +=
            "\nfilter      what rays add to the prediction is filtered, which leaves less noise: "
            "biased, less so with more rays";
    return text + "\n";
}

}  // namespace

std::string explain(FrameRequest frame, const Forecast& forecast) {
    const EstimatorContext& context = frame.estimator.context();
    const RenderOptions& options = frame.options;
    RenderStats pilot, picture;
    frame.plan = planFrame(frame, pilot);
    FrameRequest smaller = frame;
    RenderOptions& small = smaller.options;
    // A thumbnail has edges in many more of its pixels.
    if (smaller.plan.antialiasing) smaller.plan.antialiasing->most = 1;
    const FilmRectangle region = options.region();
    const double pixels = static_cast<double>(region.width) * region.height;
    const auto [width, height] = thumbnailSize(options.width, options.height);
    small.crop.reset();
    small.width = width;
    small.height = height;
    const Film plain = render(smaller, picture);
    // A second time for what the cache predicts, which is not part of the work to be timed.
    small.insight = forecast.estimator.needsCache;
    RenderStats unused;
    const Means means =
        meansOf(small.insight ? render(smaller, unused) : plain, context.environment);

    const double scale = pixels / (static_cast<double>(small.width) * small.height);
    const double seconds = pilot.seconds + picture.seconds * scale;
    std::string text = line("estimator   %s%s: %s\n", forecast.estimator.name,
                            forecast.chosen ? "" : " by default", forecast.estimator.summary);
    text += line("picture     %dx%d, %.0f %% of it the set, %d frame%s\n", options.width,
                 options.height, 100 * means.set, forecast.frames, forecast.frames > 1 ? "s" : "");
    text += line(
        "samples     %d a camera ray, %d camera ray%s a pixel; %.1f shadow rays a pixel "
        "of the set\n",
        options.samples, options.cameraRays, options.cameraRays > 1 ? "s" : "", means.rays);
    if (context.cache) text += cacheLines(*context.cache, means, small.insight);
    text += noiseLine(means, small.insight, options);
    text += line("time        %s a frame, %s for all, on %d threads; loading took %s\n",
                 durationText(seconds).c_str(), durationText(seconds * forecast.frames).c_str(),
                 threadCount(), durationText(forecast.setupSeconds).c_str());
    return text;
}

}  // namespace shadowcache
