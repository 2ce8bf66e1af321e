#include "render/integrator.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numeric>
#include <span>
#include <string>

#include "common/error.h"
#include "common/parallel.h"
#include "common/placed_mesh.h"
#include "common/progress.h"
#include "common/sequence.h"
#include "render/neighbour_groups.h"

namespace shadowcache {

namespace {

/// Side of the square of pixels that are rendered in a run: neighbours read the same cache items.
constexpr int kTile = 16;

/// Places of the frame that a survey looks at.
constexpr int kSurveyPlaces = 1024;

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
    NeighbourGroups groups;
    std::vector<ShadingPoint> together;
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
        const double aspect = static_cast<double>(options.width) / options.height;
        const Vec3f origin(rayStart(camera, filmX, filmY, aspect) - context.scene.mesh().origin);
        const Vec3f direction(rayDirection(camera, filmX, filmY, aspect));
        return {direction, context.scene.intersect(origin, direction)};
    }

    ShadingPoint shadingPoint(const View& view, std::uint64_t seed, int filmX, int filmY) const {
        const Hit& hit = view.hit;
        const Vec3f normal = hit.normal.dot(view.direction) > 0 ? -hit.normal : hit.normal;
        return {hit.scene->rayOrigin(hit.position, hit.triangle, normal),
                context.scene.mesh().origin + Vec3d(hit.position),
                normal,
                seed,
                filmX,
                filmY};
    }

    /// Renders pixels (x0, y0) .. (x0 + kTile - 1, y0 + kTile - 1) as far as the film goes: pixel
    /// (x0 + u, y0 + v) goes to out[kTile * v + u].
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
                const std::uint64_t seed = pixelSeed(options.seed, number, x, y, k);
                scratch.points.push_back(shadingPoint(view, seed, x, y));
                scratch.seen.push_back({view.hit, &pixel});
            }
        scratch.groups.group(scratch.points);
        for (std::size_t g = 0; g < scratch.groups.size(); ++g) {
            const std::span<const std::uint32_t> members = scratch.groups[g];
            scratch.together.clear();
            for (const std::uint32_t i : members) scratch.together.push_back(scratch.points[i]);
            scratch.estimates.resize(members.size());
            estimator.estimate(scratch.together, options.samples, workspace, scratch.estimates);
            for (std::size_t i = 0; i < members.size(); ++i) {
                const TileScratch::Seen& seen = scratch.seen[members[i]];
                addToPixel(scratch.together[i], seen.hit, scratch.estimates[i], workspace,
                           *seen.pixel);
            }
        }
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
        const TriangleMesh& mesh = hit.scene->mesh();
        const Rgb albedo = albedoAt(mesh, placedTriangle(mesh, hit.triangle).triangle, hit.u, hit.v,
                                    options.albedo);
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

/// The tiles of a film, row by row.
class Tiles {
public:
    explicit Tiles(const RenderOptions& options)
        : width_(options.width),
          height_(options.height),
          across_((options.width + kTile - 1) / kTile),
          down_((options.height + kTile - 1) / kTile) {}

    std::size_t count() const {
        return static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_);
    }
    int x(std::size_t tile) const { return static_cast<int>(tile) % across_ * kTile; }
    int y(std::size_t tile) const { return static_cast<int>(tile) / across_ * kTile; }

    /// Calls visit(index in the tile, index in the film) for every pixel of the tile.
    template <class Visit>
    void visit(std::size_t tile, const Visit& visit) const {
        const int x0 = x(tile), y0 = y(tile);
        for (int v = 0; v < std::min(kTile, height_ - y0); ++v)
            for (int u = 0; u < std::min(kTile, width_ - x0); ++u)
                visit(static_cast<std::size_t>(v * kTile + u),
                      static_cast<std::size_t>(y0 + v) * static_cast<std::size_t>(width_) +
                          static_cast<std::size_t>(x0 + u));
    }

private:
    int width_, height_, across_, down_;
};

/// Renders `chosen` tiles in parallel and hands each to `take` with its pixels.
template <class Take>
void renderTiles(const Frame& task, std::span<const std::size_t> chosen, RenderStats& stats,
                 const Take& take) {
    const auto start = std::chrono::steady_clock::now();
    const Tiles tiles(task.options);
    std::atomic<std::uint64_t> cameraRays{0}, shadowRays{0}, setup{0}, trace{0};
    const std::size_t run = task.estimator.inOrder() ? std::max<std::size_t>(1, chosen.size()) : 4;
    parallelFor(chosen.size(), run, [&](const Chunk& chunk) {
        const std::unique_ptr<Workspace> workspace = task.estimator.makeWorkspace();
        TileScratch scratch;
        std::array<Pixel, kTile * kTile> pixels;
        double rays = 0;
        std::uint64_t count = 0;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            throwIfInterrupted();
            const std::size_t t = chosen[i];
            task.renderTile(tiles.x(t), tiles.y(t), scratch, *workspace, pixels.data());
            tiles.visit(t, [&](std::size_t inTile, std::size_t) {
                rays += static_cast<double>(pixels[inTile].rays);
                ++count;
            });
            take(t, pixels);
        }
        shadowRays += static_cast<std::uint64_t>(rays);
        cameraRays += count * static_cast<std::uint64_t>(task.options.cameraRays);
        setup += workspace->setupNanoseconds;
        trace += workspace->traceNanoseconds;
    });
    stats.seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    stats.setupSeconds += static_cast<double>(setup) * 1e-9 / threadCount();
    stats.traceSeconds += static_cast<double>(trace) * 1e-9 / threadCount();
    stats.cameraRays += cameraRays;
    stats.shadowRays += shadowRays;
}

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
        const double u = toUnit(hashWords(seed, 1)), v = toUnit(hashWords(seed, 2));
        const View view = task.look(u, v);
        if (view.hit.found)
            points.push_back(task.shadingPoint(view, seed, static_cast<int>(u * options.width),
                                               static_cast<int>(v * options.height)));
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
    Film film{options.width, options.height, {}};
    film.pixels.resize(static_cast<std::size_t>(options.width) *
                       static_cast<std::size_t>(options.height));
    const Tiles tiles(options);
    std::vector<std::size_t> all(tiles.count());
    std::iota(all.begin(), all.end(), std::size_t{0});
    Progress progress("frame " + std::to_string(frame), all.size());
    renderTiles({estimator, context, camera, frame, options}, all, stats,
                [&](std::size_t t, std::span<const Pixel> pixels) {
                    tiles.visit(t, [&](std::size_t inTile, std::size_t inFilm) {
                        film.pixels[inFilm] = pixels[inTile];
                    });
                    progress.add(1);
                });
    requireFinite(film, frame, options.seed);
    return film;
}

std::vector<Pixel> renderSomeTiles(const Estimator& estimator, const EstimatorContext& context,
                                   const Camera& camera, int frame, const RenderOptions& options,
                                   int apart, RenderStats& stats) {
    const Tiles tiles(options);
    std::vector<std::size_t> some;
    const auto step = static_cast<std::size_t>(apart);
    for (std::size_t t = 0; t < tiles.count(); t += step)
        some.push_back(std::min(t + hashWords(options.seed, 82, t) % step, tiles.count() - 1));
    std::vector<std::vector<Pixel>> parts(some.size());
    renderTiles({estimator, context, camera, frame, options}, some, stats,
                [&](std::size_t t, std::span<const Pixel> pixels) {
                    tiles.visit(t, [&](std::size_t inTile, std::size_t) {
                        parts[t / step].push_back(pixels[inTile]);
                    });
                });
    std::vector<Pixel> found;
    for (const auto& part : parts) found.insert(found.end(), part.begin(), part.end());
    return found;
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
