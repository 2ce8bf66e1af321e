#include "render/frame/integrator.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <numeric>
#include <span>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/base/progress.h"
#include "common/base/sequence.h"
#include "common/mesh/placed_mesh.h"

namespace shadowcache {

namespace {

/// Side of the square of pixels that are rendered in a run: they read the same cache items, and
/// tell one another what they find.
constexpr int kTile = 16;

/// Pixels belong to a tile up to this far from its square: what a tile shares makes its errors
/// alike, and straight borders would be seen.
constexpr int kReach = 2;

/// Camera rays of a pixel that are lit together. More would need more memory and gain little.
constexpr int kPassRays = 64;

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

struct FilmPlace {
    int x, y;
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
    explicit Frame(const FrameRequest& request)
        : estimator(request.estimator),
          context(estimator.context()),
          camera(request.camera),
          number(request.number),
          options(request.options) {}

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

    /// Renders the pixels of a tile: places[i] goes to out[i].
    void renderTile(std::span<const FilmPlace> places, TileScratch& scratch, Workspace& workspace,
                    std::span<Pixel> out) const {
        std::fill(out.begin(), out.end(), Pixel{});
        for (int first = 0; first < options.cameraRays; first += kPassRays)
            addCameraRays(places, first, std::min(kPassRays, options.cameraRays - first), scratch,
                          workspace, out);
        const float scale = 1.0f / static_cast<float>(options.cameraRays);
        for (Pixel& pixel : out) {
            pixel.color *= scale;
            pixel.irradiance *= scale;
            pixel.albedo *= scale;
            pixel.normal *= scale;
            pixel.position *= scale;
            pixel.depth *= scale;
            pixel.variance *= scale * scale;
            pixel.openness *= scale;
            // Errors of camera rays are independent.
            pixel.expectedNoise = std::sqrt(pixel.expectedNoise) * scale;
            pixel.items *= scale;
            pixel.regions *= scale;
            pixel.misses *= scale;
        }
    }

    /// Camera rays `first` to `first + count - 1` of each pixel of a tile; what they see is lit
    /// together.
    void addCameraRays(std::span<const FilmPlace> places, int first, int count,
                       TileScratch& scratch, Workspace& workspace, std::span<Pixel> out) const {
        scratch.points.clear();
        scratch.seen.clear();
        for (std::size_t i = 0; i < places.size(); ++i) {
            const auto [x, y] = places[i];
            const std::uint64_t seed = pixelSeed(options.seed, number, x, y, 0);
            for (int k = first; k < first + count; ++k) {
                const View view = look(x, y, k);
                if (!view.hit.found) {
                    out[i].color += context.environment.radiance(view.direction);
                    continue;
                }
                ShadingPoint& point = scratch.points.emplace_back(shadingPoint(view, seed, x, y));
                point.cameraRay = static_cast<std::uint32_t>(k);
                point.pixel = static_cast<std::uint32_t>(i);
                scratch.seen.push_back({view.hit, &out[i]});
            }
        }
        scratch.estimates.resize(scratch.points.size());
        const PointBatch batch{scratch.points,
                               options.samples,
                               static_cast<std::uint32_t>(places.size()),
                               static_cast<std::uint32_t>(count),
                               static_cast<std::uint32_t>(first),
                               static_cast<std::uint32_t>(options.cameraRays) *
                                   static_cast<std::uint32_t>(options.samples)};
        estimator.estimate(batch, workspace, scratch.estimates);
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
        pixel.rays += static_cast<float>(e.rays + e.reused);
        if (options.insight && estimator.insights())
            addInsight(estimator.insights()->insight(point, options.samples, workspace), pixel);
    }

    static void addInsight(const CacheInsight& insight, Pixel& pixel) {
        pixel.openness += insight.openness;
        pixel.expectedNoise += insight.expectedNoise * insight.expectedNoise;
        pixel.items += static_cast<float>(insight.items);
        pixel.regions += static_cast<float>(insight.regions);
        pixel.misses += insight.items == 0 ? 1.0f : 0.0f;
    }
};

/// The bits of x and y in turns.
std::uint32_t mortonCode(std::uint32_t x, std::uint32_t y) {
    std::uint32_t code = 0;
    for (unsigned bit = 0; bit < 16; ++bit)
        code |= (x >> bit & 1u) << (2 * bit) | (y >> bit & 1u) << (2 * bit + 1);
    return code;
}

/// The tiles of a film, row by row. Every pixel belongs to one, near its square or in it.
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

    /// Number of the tile that a pixel belongs to.
    std::size_t tileOf(int x, int y) const {
        const std::uint64_t hash =
            hashWords(84, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
        const auto shaken = [&](int place, int shift, int tiles) {
            const int shake = static_cast<int>(hash >> shift & 0xffff) * (2 * kReach + 1) >> 16;
            return std::clamp((place + shake - kReach + kTile) / kTile - 1, 0, tiles - 1);
        };
        return static_cast<std::size_t>(shaken(y, 16, down_)) * static_cast<std::size_t>(across_) +
               static_cast<std::size_t>(shaken(x, 0, across_));
    }

    /// The pixels of a tile along a Morton curve, so that a run of them is a compact patch.
    void findPlaces(std::size_t tile, std::vector<FilmPlace>& places) const {
        places.clear();
        const int x0 = static_cast<int>(tile) % across_ * kTile,
                  y0 = static_cast<int>(tile) / across_ * kTile;
        for (int y = std::max(0, y0 - kReach); y < std::min(y0 + kTile + kReach, height_); ++y)
            for (int x = std::max(0, x0 - kReach); x < std::min(x0 + kTile + kReach, width_); ++x)
                if (tileOf(x, y) == tile) places.push_back({x, y});
        const auto code = [&](const FilmPlace& p) {
            return mortonCode(static_cast<std::uint32_t>(p.x - x0 + kReach),
                              static_cast<std::uint32_t>(p.y - y0 + kReach));
        };
        std::ranges::sort(places, {}, code);
    }

private:
    int width_, height_, across_, down_;
};

/// Workspaces that go from one chunk of a frame to the next: what one has met is kept.
class Workspaces {
public:
    explicit Workspaces(const Estimator& estimator) : estimator_(estimator) {}

    std::unique_ptr<Workspace> take() {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) return estimator_.makeWorkspace();
        std::unique_ptr<Workspace> workspace = std::move(free_.back());
        free_.pop_back();
        return workspace;
    }

    void giveBack(std::unique_ptr<Workspace> workspace) {
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(workspace));
    }

    /// Of all that were given back.
    const std::vector<std::unique_ptr<Workspace>>& free() const { return free_; }

private:
    const Estimator& estimator_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<Workspace>> free_;
};

/// Renders `chosen` tiles in parallel and hands each to `take` with its pixels.
template <class Take>
void renderTiles(const Frame& task, std::span<const std::size_t> chosen, RenderStats& stats,
                 const Take& take) {
    const auto start = std::chrono::steady_clock::now();
    const Tiles tiles(task.options);
    std::atomic<std::uint64_t> cameraRays{0}, shadowRays{0};
    Workspaces workspaces(task.estimator);
    const std::size_t run = task.estimator.inOrder() ? std::max<std::size_t>(1, chosen.size()) : 4;
    parallelFor(chosen.size(), run, [&](const Chunk& chunk) {
        std::unique_ptr<Workspace> workspace = workspaces.take();
        TileScratch scratch;
        std::vector<FilmPlace> places;
        std::vector<Pixel> pixels;
        double rays = 0;
        std::uint64_t count = 0;
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            throwIfInterrupted();
            const std::size_t t = chosen[i];
            tiles.findPlaces(t, places);
            pixels.resize(places.size());
            task.renderTile(places, scratch, *workspace, pixels);
            for (const Pixel& pixel : pixels) rays += static_cast<double>(pixel.rays);
            count += pixels.size();
            take(t, places, pixels);
        }
        shadowRays += static_cast<std::uint64_t>(rays);
        cameraRays += count * static_cast<std::uint64_t>(task.options.cameraRays);
        workspaces.giveBack(std::move(workspace));
    });
    std::uint64_t setup = 0, trace = 0;
    for (const auto& workspace : workspaces.free()) {
        setup += workspace->setupNanoseconds;
        trace += workspace->traceNanoseconds;
    }
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

void runPilot(const FrameRequest& frame, RenderStats& stats) {
    const RenderOptions& options = frame.options;
    FramePilot* pilot = frame.estimator.pilot();
    if (options.samples == 0 || !pilot) return;
    const auto start = std::chrono::steady_clock::now();
    const Frame task(frame);
    std::vector<ShadingPoint> points;
    for (int k = 0; k < kSurveyPlaces; ++k) {
        // The numbers of a survey belong to no pixel.
        const std::uint64_t seed = pixelSeed(options.seed, frame.number, -1, -1, k);
        const double u = toUnit(hashWords(seed, 1)), v = toUnit(hashWords(seed, 2));
        const View view = task.look(u, v);
        if (view.hit.found)
            points.push_back(task.shadingPoint(view, seed, static_cast<int>(u * options.width),
                                               static_cast<int>(v * options.height)));
    }
    stats.shadowRays += pilot->run(points, options.samples);
    stats.cameraRays += kSurveyPlaces;
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    stats.seconds += seconds;
    stats.setupSeconds += seconds;
}

Film render(const FrameRequest& frame, RenderStats& stats) {
    const RenderOptions& options = frame.options;
    Film film{options.width, options.height, {}};
    film.pixels.resize(static_cast<std::size_t>(options.width) *
                       static_cast<std::size_t>(options.height));
    const Tiles tiles(options);
    std::vector<std::size_t> all(tiles.count());
    std::iota(all.begin(), all.end(), std::size_t{0});
    Progress progress("frame " + std::to_string(frame.number), all.size());
    renderTiles(Frame(frame), all, stats,
                [&](std::size_t, std::span<const FilmPlace> places, std::span<const Pixel> pixels) {
                    for (std::size_t i = 0; i < places.size(); ++i)
                        film.pixels[static_cast<std::size_t>(places[i].y) *
                                        static_cast<std::size_t>(film.width) +
                                    static_cast<std::size_t>(places[i].x)] = pixels[i];
                    progress.add(1);
                });
    requireFinite(film, frame.number, options.seed);
    return film;
}

std::vector<Pixel> renderSomeTiles(const FrameRequest& frame, int apart, RenderStats& stats) {
    const Tiles tiles(frame.options);
    std::vector<std::size_t> some;
    const auto step = static_cast<std::size_t>(apart);
    for (std::size_t t = 0; t < tiles.count(); t += step)
        some.push_back(
            std::min(t + hashWords(frame.options.seed, 82, t) % step, tiles.count() - 1));
    std::vector<std::vector<Pixel>> parts(some.size());
    renderTiles(Frame(frame), some, stats,
                [&](std::size_t t, std::span<const FilmPlace>, std::span<const Pixel> pixels) {
                    parts[t / step].assign(pixels.begin(), pixels.end());
                });
    std::vector<Pixel> found;
    for (const auto& part : parts) found.insert(found.end(), part.begin(), part.end());
    return found;
}

Pixel renderPixel(const FrameRequest& frame, int x, int y, const CameraSampleObserver& observer) {
    const auto workspace = frame.estimator.makeWorkspace();
    TileScratch scratch;
    std::vector<FilmPlace> places;
    const Tiles tiles(frame.options);
    tiles.findPlaces(tiles.tileOf(x, y), places);
    std::vector<Pixel> pixels(places.size());
    const auto place = std::find_if(places.begin(), places.end(),
                                    [&](const FilmPlace& p) { return p.x == x && p.y == y; });
    const Pixel& pixel = pixels[static_cast<std::size_t>(place - places.begin())];
    Frame task(frame);
    task.observer = &observer;
    task.observed = &pixel;
    task.renderTile(places, scratch, *workspace, pixels);
    return pixel;
}

}  // namespace shadowcache
