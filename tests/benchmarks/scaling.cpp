// Time per pixel of `cache` and of `mis` as items and triangles grow by powers of ten.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/import/load_mesh.h"
#include "scenes/sets.h"
#include "tests/benchmarks/antialiased.h"

namespace shadowcache::bench {

namespace {

std::unique_ptr<Set> makeScatter(const Settings& settings, std::int64_t triangles) {
    std::filesystem::create_directories(settings.work);
    const std::filesystem::path path = settings.work / "scatter.ply";
    scenes::writeScatter(path, triangles);
    auto set = std::make_unique<Set>();
    set->name = "scatter";
    set->mesh = loadMesh({&path, 1}, {});
    std::filesystem::remove(path);
    const scenes::CameraKey key = scenes::scatterWalk(triangles)[0];
    set->cameras.frames.push_back(lookAt(key.position, key.target, {0, 1, 0}, 0.9));
    set->scene = std::make_unique<Scene>(set->mesh);
    return set;
}

constexpr Split kSplit{16, 4};

struct Point {
    double triangles = 0, items = 0;
    /// Processor seconds a pixel, over the threads.
    double prediction = 0, cache = 0, mis = 0;
};

Point measure(const Settings& settings, const Set& set, double spacing) {
    BakeOptions bake = settings.bake;
    bake.spacing = spacing;
    const BakedCache baked = bakeCache(settings, set, bake, "scaling");
    const Environment sky({1, 1, {Rgb(1, 1, 1)}}, 0, Rgb(0.2126f, 0.7152f, 0.0722f));
    const EstimatorContext context{*set.scene, sky, baked.cache.get(), {}};
    const auto perPixel = [&](const std::string& estimator, const Split& split) {
        RenderOptions options;
        options.width = settings.width;
        options.height = settings.height;
        options.cameraRays = split.cameraRays;
        options.samples = split.samples;
        double best = 0;
        for (int i = 0; i < settings.repeats; ++i) {
            const double seconds = renderWith(context, set, estimator, 1, options).processorSeconds;
            best = i == 0 ? seconds : std::min(best, seconds);
        }
        return best / (settings.width * settings.height);
    };
    const Point point{static_cast<double>(set.mesh.triangles.size()),
                      static_cast<double>(baked.cache->itemCount()), perPixel("cache", {1, 0}),
                      perPixel("cache", kSplit), perPixel("mis", kSplit)};
    std::printf("%12.0f %9.4g %12.0f %9.1f %12.2f %12.2f %12.2f\n", point.triangles, spacing,
                point.items, baked.seconds, point.prediction * 1e6, point.cache * 1e6,
                point.mis * 1e6);
    std::fflush(stdout);
    return point;
}

void judge(const char* what, const std::vector<Point>& points, JsonFile& json) {
    for (const auto& [name, seconds] :
         {std::pair{"prediction", &Point::prediction}, std::pair{"cache", &Point::cache},
          std::pair{"mis", &Point::mis}}) {
        double least = points[0].*seconds, most = least;
        for (const Point& p : points) {
            least = std::min(least, p.*seconds);
            most = std::max(most, p.*seconds);
        }
        std::printf("%s, %s: slowest over fastest %.2f (flat: below 2)\n", what, name,
                    most / least);
        json.set(std::string(what) + "." + name + ".slowest_over_fastest", most / least);
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::string key = fmt::format("{}.step{}", what, i);
        json.set(key + ".triangles", points[i].triangles);
        json.set(key + ".items", points[i].items);
        json.set(key + ".seconds_per_pixel.prediction", points[i].prediction);
        json.set(key + ".seconds_per_pixel.cache", points[i].cache);
        json.set(key + ".seconds_per_pixel.mis", points[i].mis);
    }
}

}  // namespace

void scaling(const Settings& settings) {
    JsonFile json;
    std::printf(
        "Microseconds of the processor a pixel over the threads, %dx%d, constant sky\n"
        "%12s %9s %12s %9s %12s %12s %12s\n",
        settings.width, settings.height, "triangles", "spacing", "items", "bake s", "0 samples",
        ("cache " + kSplit.name()).c_str(), ("mis " + kSplit.name()).c_str());
    // Items go roughly with the inverse square of the spacing.
    std::vector<double> spacings{1.0, 0.32, 0.1};
    std::vector<std::int64_t> triangles{100'000, 1'000'000};
    if (settings.full) {
        spacings.push_back(0.032);
        triangles.push_back(10'000'000);
    }
    std::vector<Point> byItems, byTriangles;
    {
        const auto set = makeScatter(settings, 1'000'000);
        for (const double spacing : spacings) byItems.push_back(measure(settings, *set, spacing));
    }
    // The ground grows with the triangles: the spacing with its side, so that the items stay.
    for (const std::int64_t count : triangles)
        byTriangles.push_back(measure(settings, *makeScatter(settings, count),
                                      0.32 * std::sqrt(static_cast<double>(count) / 1e6)));
    judge("items", byItems, json);
    judge("triangles", byTriangles, json);
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
