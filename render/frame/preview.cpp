#include "render/frame/preview.h"

#include <algorithm>

#include "common/base/parallel.h"
#include "render/frame/film_parts.h"
#include "render/frame/pixel_width.h"
#include "render/frame/preview_correction.h"
#include "render/frame/render_timer.h"
#include "render/frame/residual_filter.h"

namespace shadowcache {

namespace {

/// Pixels that one thread takes at a time.
constexpr std::size_t kPreviewChunk = 4096;

/// What rays add to the predicted irradiance.
Rgb addedIrradiance(const Pixel& pixel) {
    Rgb added(0, 0, 0);
    for (int k = 0; k < 3; ++k)
        if (pixel.diffuseAlbedo[k] > 0)
            added[k] = static_cast<float>(kPi) * (pixel.color[k] - pixel.predicted[k]) /
                       pixel.diffuseAlbedo[k];
    return added;
}

ResidualPixel residualOf(const FrameRequest& frame, const Pixel& pixel) {
    ResidualPixel result;
    if (!(pixel.coverage > 0)) return result;
    result.residual = addedIrradiance(pixel);
    const float scale = 1 / pixel.coverage;
    const float length = pixel.normal.length();
    if (length > 0) result.normal = pixel.normal / length;
    result.variance = pixel.sampleVariance;
    result.position = pixel.position * scale;
    result.width = pixelWidth(frame.camera.open, frame.options, pixel.depth * scale);
    return result;
}

Film cropped(const Film& film, const RenderOptions& options) {
    Film part = makeFilm(options);
    part.groups = film.groups;
    part.groupColors.assign(part.pixels.size(), film.groups.size());
    const FilmRectangle region = options.region();
    for (int y = 0; y < region.height; ++y) {
        const std::ptrdiff_t from =
            static_cast<std::ptrdiff_t>(y + region.y - film.y) * film.width + region.x - film.x;
        const std::ptrdiff_t to = static_cast<std::ptrdiff_t>(y) * region.width;
        std::copy_n(film.pixels.begin() + from, region.width, part.pixels.begin() + to);
        for (int x = 0; !film.groups.empty() && x < region.width; ++x)
            std::ranges::copy(film.groupColors[static_cast<std::size_t>(from + x)],
                              part.groupColors[static_cast<std::size_t>(to + x)].begin());
    }
    return part;
}

}  // namespace

FrameRequest withPreviewMargin(const FrameRequest& frame) {
    FrameRequest wide = frame;
    if (!frame.options.preview) return wide;
    const FilmRectangle region = frame.options.region();
    const int left = std::max(0, region.x - kResidualReach),
              top = std::max(0, region.y - kResidualReach);
    wide.options.crop = FilmRectangle{
        left, top, std::min(frame.options.width, region.x + region.width + kResidualReach) - left,
        std::min(frame.options.height, region.y + region.height + kResidualReach) - top};
    return wide;
}

Film finishFilm(const FrameRequest& frame, Film film, RenderStats& stats) {
    if (!frame.options.preview && !frame.plan.previewCorrection) return film;
    const RenderTimer time(stats);
    if (frame.plan.previewCorrection) {
        frame.plan.previewCorrection->correct(film);
        return film;
    }
    const Environment& environment = frame.estimator.context().environment;
    ResidualImage residuals{film.width, film.height, {}};
    residuals.pixels.resize(film.pixels.size());
    const auto forEachPixel = [&](const auto& visit) {
        parallelFor(film.pixels.size(), kPreviewChunk, [&](const Chunk& chunk) {
            for (std::size_t i = chunk.begin; i < chunk.end; ++i)
                visit(film.pixels[i], residuals.pixels[i]);
        });
    };
    forEachPixel(
        [&](const Pixel& pixel, ResidualPixel& residual) { residual = residualOf(frame, pixel); });
    filterResiduals(residuals, environment.luminanceWeights());
    forEachPixel([&](Pixel& pixel, const ResidualPixel& residual) {
        if (!(residual.width > 0)) return;
        pixel.irradiance += pixel.coverage * (residual.residual - addedIrradiance(pixel));
        pixel.variance = residual.variance;
        const Rgb reflectance = pixel.diffuseAlbedo * static_cast<float>(1 / kPi);
        pixel.diffuse -= pixel.color;
        pixel.color = pixel.predicted + reflectance * residual.residual;
        pixel.diffuse += pixel.color;
        const float luminance = environment.luminance(reflectance);
        pixel.colorVariance = luminance * luminance * residual.variance + pixel.glossVariance;
    });
    const FilmRectangle region = frame.options.region();
    if (region.width == film.width && region.height == film.height) return film;
    return cropped(film, frame.options);
}

}  // namespace shadowcache
