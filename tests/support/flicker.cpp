#include "tests/support/flicker.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/frame/pilot.h"
#include "render/table/estimator_table.h"

namespace shadowcache::test {

namespace {

/// A pixel still sees a place if what it sees is within so many pixels of it.
constexpr double kReachInPixels = 2;

/// The pixel whose view a place is in, if it is in the picture at all.
std::optional<std::size_t> pixelOf(const Camera& camera, const Vec3d& place,
                                   const RenderOptions& picture) {
    const Vec3d towards = place - camera.origin;
    const double depth = towards.dot(camera.forward);
    if (depth <= 0) return std::nullopt;
    const double tangent = std::tan(camera.fovY / 2) * depth;
    const double aspect = static_cast<double>(picture.width) / picture.height;
    const Vec3d right = camera.forward.cross(camera.up);
    const double x = (towards.dot(right) / (tangent * aspect) + 1) / 2 * picture.width;
    const double y = (1 - towards.dot(camera.up) / tangent) / 2 * picture.height;
    if (!(x >= 0 && x < picture.width && y >= 0 && y < picture.height)) return std::nullopt;
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
           static_cast<std::size_t>(x);
}

/// What the pixels of a frame look at; depth 0 where it is the sky.
std::vector<Pixel> firstHits(const EstimatorContext& context, const Camera& camera,
                             const RenderOptions& options) {
    RenderOptions quick = options;
    quick.samples = 1;
    RenderStats unused;
    return render({*findEstimator("cosine").make(context), camera, 1, quick}, unused).pixels;
}

}  // namespace

ShotLight renderShot(const EstimatorContext& context, const std::string& estimator,
                     std::span<const Camera> cameras, std::span<const int> numbers,
                     const RenderOptions& options, RenderStats& stats,
                     const EstimatorOptions& estimatorOptions) {
    const auto made = findEstimator(estimator).make(context, estimatorOptions);
    ShotLight shot;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        FrameRequest frame{*made, cameras[i], numbers[i], options};
        frame.plan = planFrame(frame, stats);
        const Film film = render(frame, stats);
        shot.emplace_back();
        for (const Pixel& p : film.pixels)
            shot.back().push_back(static_cast<double>(context.environment.luminance(p.irradiance)));
    }
    return shot;
}

Places trackPlaces(const EstimatorContext& context, std::span<const Camera> cameras,
                   const RenderOptions& options) {
    std::vector<Vec3d> places;
    for (const Pixel& p : firstHits(context, cameras[0], options))
        if (p.depth > 0) places.emplace_back(p.position);
    std::vector<char> seen(places.size(), 1);
    std::vector<std::vector<std::size_t>> found(cameras.size(),
                                                std::vector<std::size_t>(places.size()));
    for (std::size_t f = 0; f < cameras.size(); ++f) {
        const std::vector<Pixel> hits = firstHits(context, cameras[f], options);
        const double pixelAngle = cameras[f].fovY / options.height;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const auto pixel = pixelOf(cameras[f], places[i], options);
            const double reach =
                kReachInPixels * pixelAngle * (places[i] - cameras[f].origin).length();
            // Further off, something else stands before it.
            if (!pixel || hits[*pixel].depth <= 0 ||
                (Vec3d(hits[*pixel].position) - places[i]).length() > reach)
                seen[i] = 0;
            else
                found[f][i] = *pixel;
        }
    }
    Places tracked{std::vector<std::vector<std::size_t>>(cameras.size())};
    for (std::size_t i = 0; i < places.size(); ++i)
        if (seen[i])
            for (std::size_t f = 0; f < cameras.size(); ++f)
                tracked.pixels[f].push_back(found[f][i]);
    return tracked;
}

Places samePixels(const Places& places) {
    return {std::vector(places.pixels.size(), places.pixels.front())};
}

ShotLight errorsOf(const ShotLight& shot, const ShotLight& reference) {
    ShotLight errors = shot;
    for (std::size_t f = 0; f < shot.size(); ++f)
        for (std::size_t i = 0; i < shot[f].size(); ++i) errors[f][i] -= reference[f][i];
    return errors;
}

std::vector<double> brightness(const ShotLight& reference, const Places& places) {
    std::vector<double> mean(places.count(), 0.0);
    double all = 0;
    for (std::size_t i = 0; i < mean.size(); ++i) {
        for (std::size_t f = 0; f < reference.size(); ++f)
            mean[i] += reference[f][places.pixels[f][i]] / static_cast<double>(reference.size());
        all += mean[i] / static_cast<double>(mean.size());
    }
    for (double& m : mean) m = std::sqrt(m * m + 0.01 * all * all);
    return mean;
}

double temporalVariance(const ShotLight& shot, const Places& places,
                        std::span<const double> brightness) {
    const auto frames = static_cast<double>(shot.size());
    double total = 0;
    for (std::size_t i = 0; i < places.count(); ++i) {
        const auto light = [&](std::size_t f) {
            return shot[f][places.pixels[f][i]] / brightness[i];
        };
        double mean = 0, squares = 0;
        for (std::size_t f = 0; f < shot.size(); ++f) mean += light(f) / frames;
        for (std::size_t f = 0; f < shot.size(); ++f)
            squares += (light(f) - mean) * (light(f) - mean);
        total += squares / (frames - 1);
    }
    return total / static_cast<double>(places.count());
}

std::vector<double> correlations(const ShotLight& errors, const Places& places,
                                 std::span<const double> brightness) {
    std::vector<double> found;
    for (std::size_t f = 0; f + 1 < errors.size(); ++f) {
        double both = 0, first = 0, second = 0;
        for (std::size_t i = 0; i < places.count(); ++i) {
            const double a = errors[f][places.pixels[f][i]] / brightness[i];
            const double b = errors[f + 1][places.pixels[f + 1][i]] / brightness[i];
            both += a * b;
            first += a * a;
            second += b * b;
        }
        // The errors' mean is 0: the estimators are unbiased.
        found.push_back(both / std::sqrt(first * second));
    }
    return found;
}

}  // namespace shadowcache::test
