#include "render/integrator.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <string>

#include "common/error.h"
#include "common/parallel.h"
#include "common/progress.h"
#include "common/sequence.h"

namespace shadowcache {

namespace {

/// Side of the square of pixels that are rendered in a run: neighbours read the same cache items
/// and share what their rays find.
constexpr int kTile = 8;

/// Places of the frame that a survey looks at.
constexpr int kSurveyPlaces = 1024;

Rgb albedoAt(const TriangleMesh& mesh, const Hit& hit, const Rgb& fallback) {
    if (mesh.colors.empty()) return fallback;
    const Vec3i& t = mesh.triangles[hit.triangle];
    const Rgb& a = mesh.colors[static_cast<std::size_t>(t.x)];
    const Rgb& b = mesh.colors[static_cast<std::size_t>(t.y)];
    const Rgb& c = mesh.colors[static_cast<std::size_t>(t.z)];
    return a * (1 - hit.u - hit.v) + b * hit.u + c * hit.v;
}

/// A picture with a hole is worse than none: says how many pixels failed and how to replay one.
void requireFinite(const Film& film, int frame, std::uint64_t seed) {
    const auto failed = [](const Pixel& p) { return !isFinite(p); };
    const auto first = std::find_if(film.pixels.begin(), film.pixels.end(), failed);
    if (first == film.pixels.end()) return;
    const auto i = first - film.pixels.begin();
    throw Error("frame " + std::to_string(frame) + ": " +
                std::to_string(std::count_if(first, film.pixels.end(), failed)) +
                " pixels without a finite estimate; replay the first with --debug " +
                std::to_string(i % film.width) + "," + std::to_string(i / film.width) +
                (frame == 1 ? "" : " --frames " + std::to_string(frame)) + " --seed " +
                std::to_string(seed));
}

struct View {
    Vec3f direction;
    Hit hit;
};

/// What a tile's camera rays see of the set; reused from tile to tile.
struct TileScratch {
    struct Seen {
        Hit hit;
        Pixel* pixel;
    };
    std::vector<ShadingPoint> points;
    std::vector<Seen> seen;
    std::vector<Estimate> estimates;
};

struct Frame {
    const Estimator& estimator;
    const EstimatorContext& context;
    const Camera& camera;
    int number;
    const RenderOptions& options;
    const CameraSampleObserver* observer = nullptr;
    const Pixel* observed = nullptr;

    /// What the camera sees at a place of the film, in [0, 1).
    View look(double filmX, double filmY) const {
        const Vec3f origin(camera.origin - context.scene.mesh().origin);
        const Vec3f direction(rayDirection(camera, filmX, filmY,
                                           static_cast<double>(options.width) / options.height));
        return {direction, context.scene.intersect(origin, direction)};
    }

    ShadingPoint shadingPoint(const View& view, std::uint64_t seed) const {
        const Hit& hit = view.hit;
        const Vec3f normal = hit.normal.dot(view.direction) > 0 ? -hit.normal : hit.normal;
        return {context.scene.rayOrigin(hit.position, hit.triangle, normal),
                context.scene.mesh().origin + Vec3d(hit.position), normal, seed};
    }

    /// Renders pixels (x0, y0) .. (x0 + kTile - 1, y0 + kTile - 1) as far as the film goes:
    /// out[kTile
    /// * v + u] is (x0 + u, y0 + v).
    void renderTile(int x0, int y0, TileScratch& scratch, Workspace& workspace, Pixel* out) const {
        std::fill_n(out, kTile * kTile, Pixel{});
        for (int k = 0; k < options.cameraRays; ++k)
            addCameraRays(x0, y0, k, scratch, workspace, out);
        const float scale = 1.0f / static_cast<float>(options.cameraRays);
        for (Pixel* pixel = out; pixel != out + kTile * kTile; ++pixel) {
            pixel->color *= scale;
            pixel->irradiance *= scale;
            pixel->albedo *= scale;
            pixel->normal *= scale;
            pixel->position *= scale;
            pixel->depth *= scale;
            pixel->variance *= scale * scale;
            pixel->openness *= scale;
            // Errors of camera rays are independent.
            pixel->expectedNoise = std::sqrt(pixel->expectedNoise) * scale;
            pixel->items *= scale;
            pixel->regions *= scale;
            pixel->misses *= scale;
        }
    }

    /// The camera ray `k` of each pixel of a tile; what they see is lit together.
    void addCameraRays(int x0, int y0, int k, TileScratch& scratch, Workspace& workspace,
                       Pixel* out) const {
        scratch.points.clear();
        scratch.seen.clear();
        for (int y = y0; y < std::min(y0 + kTile, options.height); ++y)
            for (int x = x0; x < std::min(x0 + kTile, options.width); ++x) {
                Pixel& pixel = out[(y - y0) * kTile + x - x0];
                const View view = look(x, y, k);
                if (!view.hit.found) {
                    pixel.color += context.environment.radiance(view.direction);
                    continue;
                }
                scratch.points.push_back(
                    shadingPoint(view, pixelSeed(options.seed, number, x, y, k)));
                scratch.seen.push_back({view.hit, &pixel});
            }
        scratch.estimates.resize(scratch.points.size());
        estimator.estimate(scratch.points, options.samples, workspace, scratch.estimates);
        for (std::size_t i = 0; i < scratch.points.size(); ++i)
            addToPixel(scratch.points[i], scratch.seen[i].hit, scratch.estimates[i], workspace,
                       *scratch.seen[i].pixel);
    }

    View look(int x, int y, int k) const {
        double dx = 0.5, dy = 0.5;
        if (options.cameraRays > 1) {
            std::uint32_t u = 0, v = 0;
            const std::uint64_t film = pixelSeed(options.seed, number, x, y, -1);
            owenSobol(static_cast<std::uint32_t>(k), 0, film, {&u, 1});
            owenSobol(static_cast<std::uint32_t>(k), 1, film, {&v, 1});
            dx = static_cast<double>(toUnitFloat(u));
            dy = static_cast<double>(toUnitFloat(v));
        }
        return look((x + dx) / options.width, (y + dy) / options.height);
    }

    void addToPixel(const ShadingPoint& point, const Hit& hit, const Estimate& e,
                    Workspace& workspace, Pixel& pixel) const {
        const Rgb albedo = albedoAt(context.scene.mesh(), hit, options.albedo);
        if (observer && &pixel == observed) {
            estimator.estimate(point, options.samples, workspace);  // for its samples
            (*observer)({point, albedo, e, workspace.samples});
        }
        pixel.color += albedo * e.irradiance * static_cast<float>(1 / kPi);
        pixel.irradiance += e.irradiance;
        pixel.albedo += albedo;
        pixel.normal += point.normal;
        pixel.position += Vec3f(point.position);
        pixel.depth += hit.distance;
        pixel.variance += e.variance;
        pixel.rays += static_cast<float>(e.rays);
        if (options.insight)
            addInsight(estimator.insight(point, options.samples, workspace), pixel);
    }

    static void addInsight(const CacheInsight& insight, Pixel& pixel) {
        pixel.openness += insight.openness;
        pixel.expectedNoise += insight.expectedNoise * insight.expectedNoise;
        pixel.items += static_cast<float>(insight.items);
        pixel.regions += static_cast<float>(insight.regions);
        pixel.misses += insight.items == 0 ? 1.0f : 0.0f;
    }
};

}  // namespace

std::uint64_t pixelSeed(std::uint64_t seed, int frame, int x, int y, int cameraRay) {
    const auto word = [](int high, int low) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(high)) << 32 |
               static_cast<std::uint32_t>(low);
    };
    return hashWords(seed, word(frame, cameraRay), word(y, x));
}

void survey(Estimator& estimator, const EstimatorContext& context, const Camera& camera, int frame,
            const RenderOptions& options, RenderStats& stats) {
    if (options.samples == 0) return;
    const auto start = std::chrono::steady_clock::now();
    const Frame task{estimator, context, camera, frame, options};
    std::vector<ShadingPoint> points;
    for (int k = 0; k < kSurveyPlaces; ++k) {
        // The numbers of a survey belong to no pixel.
        const std::uint64_t seed = pixelSeed(options.seed, frame, -1, -1, k);
        const View view = task.look(toUnit(hashWords(seed, 1)), toUnit(hashWords(seed, 2)));
        if (view.hit.found) points.push_back(task.shadingPoint(view, seed));
    }
    stats.shadowRays += estimator.survey(points, options.samples);
    stats.cameraRays += kSurveyPlaces;
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    stats.seconds += seconds;
    stats.setupSeconds += seconds;
}

Film render(const Estimator& estimator, const EstimatorContext& context, const Camera& camera,
            int frame, const RenderOptions& options, RenderStats& stats) {
    const auto start = std::chrono::steady_clock::now();
    Film film{options.width, options.height, {}};
    film.pixels.resize(static_cast<std::size_t>(options.width) *
                       static_cast<std::size_t>(options.height));
    const int tilesX = (options.width + kTile - 1) / kTile;
    const int tilesY = (options.height + kTile - 1) / kTile;
    const auto tiles = static_cast<std::size_t>(tilesX) * static_cast<std::size_t>(tilesY);
    const Frame task{estimator, context, camera, frame, options};
    std::atomic<std::uint64_t> shadowRays{0}, setup{0}, trace{0};
    Progress progress("frame " + std::to_string(frame), tiles);
    parallelFor(tiles, 16, [&](const Chunk& chunk) {
        const std::unique_ptr<Workspace> workspace = estimator.makeWorkspace();
        TileScratch scratch;
        std::array<Pixel, kTile * kTile> tile;
        double rays = 0;
        for (std::size_t t = chunk.begin; t < chunk.end; ++t) {
            throwIfInterrupted();
            const int x0 = static_cast<int>(t) % tilesX * kTile;
            const int y0 = static_cast<int>(t) / tilesX * kTile;
            task.renderTile(x0, y0, scratch, *workspace, tile.data());
            const int width = std::min(kTile, options.width - x0);
            for (int v = 0; v < std::min(kTile, options.height - y0); ++v)
                for (int u = 0; u < width; ++u) {
                    const Pixel& pixel = tile[static_cast<std::size_t>(v * kTile + u)];
                    film.pixels[static_cast<std::size_t>(y0 + v) *
                                    static_cast<std::size_t>(options.width) +
                                static_cast<std::size_t>(x0 + u)] = pixel;
                    rays += static_cast<double>(pixel.rays);
                }
        }
        shadowRays += static_cast<std::uint64_t>(rays);
        setup += workspace->setupNanoseconds;
        trace += workspace->traceNanoseconds;
        progress.add(chunk.end - chunk.begin);
    });
    stats.seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    stats.setupSeconds += static_cast<double>(setup) * 1e-9 / threadCount();
    stats.traceSeconds += static_cast<double>(trace) * 1e-9 / threadCount();
    stats.cameraRays += film.pixels.size() * static_cast<std::uint64_t>(options.cameraRays);
    stats.shadowRays += shadowRays;
    requireFinite(film, frame, options.seed);
    return film;
}

Pixel renderPixel(const Estimator& estimator, const EstimatorContext& context, const Camera& camera,
                  int frame, const RenderOptions& options, int x, int y,
                  const CameraSampleObserver& observer) {
    const auto workspace = estimator.makeWorkspace();
    TileScratch scratch;
    std::array<Pixel, kTile * kTile> tile;
    const Pixel& pixel = tile[static_cast<std::size_t>(y % kTile * kTile + x % kTile)];
    const Frame task{estimator, context, camera, frame, options, &observer, &pixel};
    task.renderTile(x - x % kTile, y - y % kTile, scratch, *workspace, tile.data());
    return pixel;
}

}  // namespace shadowcache
