// Time per pixel of `cache` as items and triangles grow by powers of ten.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/import/load_mesh.h"
#include "scenes/sets.h"
#include "tests/benchmarks/bench.h"

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

struct Point {
    double triangles = 0, items = 0;
    double preview = 0, full = 0;  ///< seconds a pixel at 0 samples and at those asked for
};

Point measure(const Settings& settings, const Set& set, double spacing) {
    BakeOptions bake = settings.bake;
    bake.spacing = spacing;
    const BakedCache baked = bakeCache(settings, set, bake, "scaling");
    const Environment sky({1, 1, {Rgb(1, 1, 1)}}, 0, Rgb(0.2126f, 0.7152f, 0.0722f));
    const EstimatorContext context{*set.scene, sky, baked.cache.get(), {}};
    const auto perPixel = [&](int samples) {
        double best = 0;
        for (int i = 0; i < settings.repeats; ++i) {
            const double seconds =
                renderFrame(context, set, "cache", 1, samples, 1, settings).stats.seconds;
            best = i == 0 ? seconds : std::min(best, seconds);
        }
        return best / (settings.width * settings.height);
    };
    Point point{static_cast<double>(set.mesh.triangles.size()),
                static_cast<double>(baked.cache->itemCount()), perPixel(0),
                perPixel(settings.samples)};
    std::printf("%12.0f %9.4g %12.0f %9.1f %14.2f %14.2f\n", point.triangles, spacing, point.items,
                baked.seconds, point.preview * 1e6, point.full * 1e6);
    std::fflush(stdout);
    return point;
}

void judge(const char* what, const std::vector<Point>& points, JsonFile& json) {
    for (const auto& [name, seconds] :
         {std::pair{"0_samples", &Point::preview}, std::pair{"all_samples", &Point::full}}) {
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
        const std::string key = std::string(what) + ".step" + std::to_string(i);
        json.set(key + ".triangles", points[i].triangles);
        json.set(key + ".items", points[i].items);
        json.set(key + ".seconds_per_pixel.0_samples", points[i].preview);
        json.set(key + ".seconds_per_pixel.all_samples", points[i].full);
    }
}

}  // namespace

void scaling(const Settings& settings) {
    JsonFile json;
    std::printf("Time per pixel of `cache`, %dx%d, constant sky\n%12s %9s %12s %9s %14s %11d %s\n",
                settings.width, settings.height, "triangles", "spacing", "items", "bake s",
                "0 samples us", settings.samples, "us");
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
