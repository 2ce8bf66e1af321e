#include "render/frame/preview.h"

#include <algorithm>
#include <cmath>

#include "render/frame/film_parts.h"
#include "render/frame/residual_filter.h"

namespace shadowcache {

namespace {

/// Width of a pixel at each unit of distance, or everywhere if the camera is orthographic.
float pixelWidth(const Camera& camera, const RenderOptions& options, float depth) {
    if (camera.height > 0) return static_cast<float>(camera.height / options.height);
    return depth * static_cast<float>(2 * std::tan(camera.fovY / 2) / options.height);
}

ResidualPixel residualOf(const FrameRequest& frame, const Pixel& pixel) {
    ResidualPixel result;
    if (!(pixel.coverage > 0)) return result;
    for (int k = 0; k < 3; ++k)
        if (pixel.albedo[k] > 0)
            result.residual[k] =
                static_cast<float>(kPi) * (pixel.color[k] - pixel.predicted[k]) / pixel.albedo[k];
    const float scale = 1 / pixel.coverage;
    const float length = pixel.normal.length();
    if (length > 0) result.normal = pixel.normal / length;
    result.variance = pixel.residualVariance;
    result.position = pixel.position * scale;
    result.width = pixelWidth(frame.camera, frame.options, pixel.depth * scale);
    return result;
}

Film cropped(const Film& film, const RenderOptions& options) {
    Film part = makeFilm(options);
    const FilmRectangle region = options.region();
    for (int y = 0; y < region.height; ++y) {
        const auto from = film.pixels.begin() +
                          static_cast<std::ptrdiff_t>(y + region.y - film.y) * film.width +
                          region.x - film.x;
        std::copy_n(from, region.width,
                    part.pixels.begin() + static_cast<std::ptrdiff_t>(y) * region.width);
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

Film finishFilm(const FrameRequest& frame, Film film) {
    if (!frame.options.preview) return film;
    const Environment& environment = frame.estimator.context().environment;
    ResidualImage residuals{film.width, film.height, {}};
    residuals.pixels.reserve(film.pixels.size());
    for (const Pixel& pixel : film.pixels) residuals.pixels.push_back(residualOf(frame, pixel));
    filterResiduals(residuals, environment.luminanceWeights());
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
        Pixel& pixel = film.pixels[i];
        const ResidualPixel& residual = residuals.pixels[i];
        if (!(residual.width > 0)) continue;
        const Rgb reflectance = pixel.albedo * static_cast<float>(1 / kPi);
        pixel.color = pixel.predicted + reflectance * residual.residual;
        const float luminance = environment.luminance(reflectance);
        pixel.colorVariance = luminance * luminance * residual.variance;
    }
    return cropped(film, frame.options);
}

}  // namespace shadowcache
