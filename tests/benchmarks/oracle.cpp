// How far the baked counts are from the best there can be: counts traced at the shading point
// itself, at the same resolution.

#include <cmath>
#include <cstdio>

#include "bake/core/default_spacing.h"
#include "bake/core/item_baker.h"
#include "common/random/sequence.h"
#include "common/shot/camera_rays.h"
#include "render/table/estimator_table.h"
#include "tests/benchmarks/bench.h"
#include "tests/support/test_scenes.h"

namespace shadowcache::bench {

namespace {

constexpr int kPlaces = 200;
constexpr int kEstimates = 40;  ///< of each place

/// A cache whose only item was traced from `point`.
test::TestCache cacheAt(const Scene& scene, const ShadingPoint& point, const BakeOptions& options) {
    BakeResult baked;
    baked.header.level = options.level;
    baked.header.spacing = options.spacing;
    baked.header.bakes = {{.rays = options.rays}};
    Patch patch;
    patch.code.side = sideOf(point.place.normal);
    patch.seed = point.slot.seed;
    patch.normal = point.place.normal;
    patch.meanPosition = Vec3f(0, 0, 0);
    patch.origin.fill(point.place.rayOrigin);
    patch.originNormal.fill(point.place.normal);
    const ItemBaker baker(scene, options);
    const Probe probe = baker.traceProbe(patch);
    const Vec3d voxel = point.place.position / options.spacing;
    store(baker.refine(patch, probe, probe.mixed(), {}), patch,
          Vec3i(static_cast<int>(std::lround(voxel.x)), static_cast<int>(std::lround(voxel.y)),
                static_cast<int>(std::lround(voxel.z))),
          baked.items);
    return test::TestCache(baked);
}

/// Places that a frame's pixels see.
std::vector<ShadingPoint> places(const Set& set, const Settings& settings) {
    std::vector<ShadingPoint> points;
    const Camera camera = cameraAtFrame(set.cameras, 1);
    const CameraRays rays(camera, static_cast<double>(settings.width) / settings.height);
    for (std::uint64_t i = 0; points.size() < kPlaces && i < 20 * kPlaces; ++i) {
        const Vec3f direction(
            rays.through({toUnit(hashWords(i, 1)), toUnit(hashWords(i, 2))}).direction);
        const Vec3f eye(camera.origin - set.scene->mesh().origin);
        if (!set.scene->intersect(eye, direction).found) continue;
        points.push_back(test::pointAlong(*set.scene, eye, direction));
        points.back().slot.seed = i;
    }
    return points;
}

/// Variance of estimates at a point, over the squared brightness (no less than `darkest`).
double relativeVariance(const Estimator& estimator, const EstimatorPlan& plan,
                        const ShadingPoint& point, int samples, double darkest) {
    const auto estimates = test::runEstimator(estimator, point, samples, kEstimates, &plan);
    const double mean = estimates.mean(1);
    return estimates.sampleVariance(1) / (mean * mean + darkest * darkest);
}

}  // namespace

void oracle(const Settings& settings) {
    JsonFile json;
    std::printf("%-9s %-13s %12s %12s %7s\n", "scene", "map", "baked", "traced", "ratio");
    for (const std::string& name : settings.scenes) {
        const auto set = loadSet(settings, name);
        BakeOptions bake = settings.bake;
        if (!(bake.spacing > 0)) bake.spacing = chooseSpacing(set->mesh);
        const BakedCache baked = bakeCache(settings, *set, bake, "oracle");
        const std::vector<ShadingPoint> points = places(*set, settings);
        for (const std::string& map : settings.maps) {
            const auto environment = loadMap(settings, map);
            const auto made =
                findEstimator("cache").make({*set->scene, *environment, baked.cache.get(), {}});
            double bright = 0;
            for (const ShadingPoint& p : points)
                bright += test::runEstimator(*made, p, 256, 1).mean(1) / kPlaces;
            const auto plan = made->pilot()->plan(points, settings.samples, 0);
            double ours = 0, best = 0;
            for (const ShadingPoint& p : points) {
                ours += relativeVariance(*made, *plan, p, settings.samples, 0.1 * bright) / kPlaces;
                const test::TestCache traced = cacheAt(*set->scene, p, bake);
                const auto there =
                    findEstimator("cache").make({*set->scene, *environment, &traced.cache(), {}});
                const auto planThere = there->pilot()->plan({&p, 1}, settings.samples, 0);
                best += relativeVariance(*there, *planThere, p, settings.samples, 0.1 * bright) /
                        kPlaces;
            }
            std::printf("%-9s %-13s %12.4g %12.4g %7.2f\n", name.c_str(), map.c_str(), ours, best,
                        ours / best);
            std::fflush(stdout);
            const std::string key = name + "." + map;
            json.set(key + ".baked_variance", ours);
            json.set(key + ".traced_variance", best);
            json.set(key + ".ratio", ours / best);
        }
    }
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
