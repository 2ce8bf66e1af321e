// Our estimators against renders of the same frames by Blender Cycles, whose code shares nothing
// with ours: agreement confirms the conventions of map and camera as well as the estimators.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "common/base/error.h"
#include "common/image/radiance.h"
#include "common/shot/camera_rays.h"
#include "render/frame/film.h"
#include "render/frame/pilot.h"
#include "render/table/estimator_table.h"
#include "tests/benchmarks/bench.h"
#include "tests/support/statistics.h"

namespace shadowcache::bench {

namespace {

/// Tiles are squares of so many pixels; those with fewer than half of them on the set are left out.
constexpr int kTile = 20;
/// Rays through a pixel, whose box filter is Cycles' one pixel.
constexpr int kCameraRays = 16;
/// A tile may differ by this much of its light without being called different: Cycles moves the
/// origins of rays otherwise, and may trace a triangle's edge otherwise.
constexpr double kTolerance = 0.01;
constexpr double kSignificance = 1e-3;

struct Case {
    const char* scene;
    const char* map;
    int frame;
    const char* file;
};
constexpr Case kCases[] = {{"kitchen", "courtyard", 1, "kitchen_courtyard_f1.exr"},
                           {"atrium", "sunrise", 120, "atrium_sunrise_f120.exr"}};

Film renderFilm(const EstimatorContext& context, const Set& set, const std::string& estimator,
                int frame, int samples, const Image& size) {
    const auto made = findEstimator(estimator).make(context);
    RenderOptions options;
    options.width = size.width;
    options.height = size.height;
    options.samples = std::max(1, samples);
    options.cameraRays = kCameraRays;
    options.filter = FilterKind::box;
    RenderStats stats;
    FrameRequest request{*made, cameraAtFrame(set.cameras, frame), frame, options};
    request.plan = planFrame(request, stats);
    return render(request, stats);
}

/// Triangles that others coincide with: from one of them Cycles' rays meet the other at once.
std::vector<bool> findDuplicates(const TriangleMesh& mesh) {
    std::map<std::array<std::array<float, 3>, 3>, std::uint32_t> seen;
    std::vector<bool> duplicate(mesh.triangles.size());
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        std::array<std::array<float, 3>, 3> corners;
        for (int k = 0; k < 3; ++k) {
            const Vec3f& p = mesh.positions[static_cast<std::size_t>(mesh.triangles[i][k])];
            corners[static_cast<std::size_t>(k)] = {p.x, p.y, p.z};
        }
        std::sort(corners.begin(), corners.end());
        const auto [first, isNew] = seen.emplace(corners, i);
        if (!isNew) duplicate[i] = duplicate[first->second] = true;
    }
    return duplicate;
}

/// Pixels fit to be compared: they and those around them show the set alone, and no duplicates.
std::vector<bool> findFitPixels(const Set& set, int frame, int width, int height) {
    const std::vector<bool> duplicate = findDuplicates(set.mesh);
    const Camera& camera = cameraAtFrame(set.cameras, frame);
    const CameraRays rays(camera, static_cast<double>(width) / height);
    const Vec3f origin(camera.origin - set.mesh.origin);
    std::vector<bool> fit(static_cast<std::size_t>(width * height), true);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Vec3f direction(rays.through({(x + 0.5) / width, (y + 0.5) / height}).direction);
            const Hit hit = set.scene->intersect(origin, direction);
            if (hit.found && !duplicate[hit.triangle]) continue;
            for (int py = std::max(0, y - 1); py <= std::min(height - 1, y + 1); ++py)
                for (int px = std::max(0, x - 1); px <= std::min(width - 1, x + 1); ++px)
                    fit[static_cast<std::size_t>(py * width + px)] = false;
        }
    return fit;
}

/// The map as Cycles sees it, linear between the middles of texels, by texels a fourth as wide.
std::unique_ptr<Environment> filteredMap(const Settings& settings, const std::string& name,
                                         double rotationDegrees) {
    constexpr int kFactor = 4;
    const RadianceImage map = readRadiance(mapFile(settings, name));
    const int width = map.image.width, height = map.image.height;
    const auto texel = [&](int x, int y) {
        const int row = std::clamp(y, 0, height - 1), column = (x + width) % width;
        return map.image.pixels[static_cast<std::size_t>(row * width + column)];
    };
    Image fine{width * kFactor, height * kFactor, {}};
    for (int y = 0; y < fine.height; ++y)
        for (int x = 0; x < fine.width; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / kFactor - 0.5f;
            const float v = (static_cast<float>(y) + 0.5f) / kFactor - 0.5f;
            const float left = std::floor(u), above = std::floor(v);
            const int i = static_cast<int>(left), j = static_cast<int>(above);
            const float du = u - left, dv = v - above;
            fine.pixels.push_back((texel(i, j) * (1 - du) + texel(i + 1, j) * du) * (1 - dv) +
                                  (texel(i, j + 1) * (1 - du) + texel(i + 1, j + 1) * du) * dv);
        }
    return std::make_unique<Environment>(fine, rotationDegrees, map.luminanceWeights);
}

/// How two pictures compare.
struct Comparison {
    double ratio = 0;      ///< ours over Cycles', all tiles together
    double tileError = 0;  ///< root mean square of the tiles' relative differences
    int tiles = 0;
    double pValue = 0;  ///< that every tile agrees within the tolerance
    bool agrees() const { return pValue > kSignificance; }
};

/// Compares luminance by tiles. Where the pictures agree, a tile's mean difference is normal with a
/// variance that the differences of its pixels tell, whatever noise both pictures have; what
/// exceeds the tolerance counts, and the sum of the squares is chi-squared or less.
Comparison compare(const Film& film, float scale, const Image& reference,
                   const std::vector<bool>& fit) {
    Comparison c;
    double ours = 0, theirs = 0, chiSquared = 0, squares = 0;
    for (int ty = 0; ty + kTile <= film.height; ty += kTile)
        for (int tx = 0; tx + kTile <= film.width; tx += kTile) {
            double sum = 0, sumSquares = 0, light = 0;
            int count = 0;
            for (int y = ty; y < ty + kTile; ++y)
                for (int x = tx; x < tx + kTile; ++x) {
                    const auto i = static_cast<std::size_t>(y * film.width + x);
                    if (!fit[i]) continue;
                    const auto a = static_cast<double>(luminance(film.pixels[i].color) * scale);
                    const auto b = static_cast<double>(luminance(reference.pixels[i]));
                    sum += a - b;
                    sumSquares += (a - b) * (a - b);
                    light += b;
                    ours += a;
                    theirs += b;
                    ++count;
                }
            if (2 * count < kTile * kTile || !(light > 0)) continue;
            const double mean = sum / count;
            const double error = std::sqrt((sumSquares / count - mean * mean) / (count - 1));
            const double excess =
                std::max(0.0, std::abs(mean) - kTolerance * light / count) / error;
            chiSquared += excess * excess;
            squares += std::pow(sum / light, 2);
            ++c.tiles;
        }
    if (c.tiles == 0) throw Error("cycles: no tile of the picture shows the set alone");
    c.ratio = ours / theirs;
    c.tileError = std::sqrt(squares / c.tiles);
    c.pValue = test::chiSquaredTail(chiSquared, c.tiles);
    return c;
}

void print(const Case& k, const std::string& what, const Comparison& c, bool expected,
           JsonFile& json) {
    std::printf("%-9s %-24s %8.4f %10.2f%% %6d %10.3g %-8s %s\n", k.scene, what.c_str(), c.ratio,
                100 * c.tileError, c.tiles, c.pValue, c.agrees() ? "agrees" : "differs",
                c.agrees() == expected ? "as it should" : "UNEXPECTED");
    std::fflush(stdout);
    const std::string key = std::string(k.scene) + "." + what;
    json.set(key + ".ratio", c.ratio);
    json.set(key + ".tile_error", c.tileError);
    json.set(key + ".p_value", c.pValue);
    json.set(key + ".as_expected", std::uint64_t{c.agrees() == expected});
}

void compareCase(const Case& k, const Settings& settings, JsonFile& json) {
    const auto set = loadSet(settings, k.scene);
    const Image reference = readRadiance(settings.data / "reference" / k.file).image;
    const std::vector<bool> fit = findFitPixels(*set, k.frame, reference.width, reference.height);
    const BakedCache baked = bakeCache(settings, *set, settings.bake, "adaptive");
    const auto environment = filteredMap(settings, k.map, 0);
    const EstimatorContext context{*set->scene, *environment, baked.cache.get(), {}};
    for (const char* estimator : {"mis", "paper", "cache"}) {
        const Film film =
            renderFilm(context, *set, estimator, k.frame, settings.samples, reference);
        print(k, estimator, compare(film, 1, reference, fit), true, json);
        if (std::string(estimator) != "cache") continue;
        print(k, "cache, 3 % brighter", compare(film, 1.03f, reference, fit), false, json);
    }
    const auto turned = filteredMap(settings, k.map, 5);
    const EstimatorContext wrong{*set->scene, *turned, baked.cache.get(), {}};
    const Film film = renderFilm(wrong, *set, "cache", k.frame, settings.samples, reference);
    print(k, "cache, map turned by 5", compare(film, 1, reference, fit), false, json);
}

}  // namespace

void cycles(const Settings& settings) {
    JsonFile json;
    std::printf(
        "%dx%d-pixel tiles of luminance, tolerance %g, significance %g; controls must "
        "differ\n%-9s %-24s %8s %11s %6s %10s\n",
        kTile, kTile, kTolerance, kSignificance, "scene", "picture", "ratio", "tile RMS", "tiles",
        "p");
    for (const Case& k : kCases)
        if (std::find(settings.scenes.begin(), settings.scenes.end(), k.scene) !=
            settings.scenes.end())
            compareCase(k, settings, json);
    if (!settings.json.empty()) json.write(settings.json);
}

}  // namespace shadowcache::bench
