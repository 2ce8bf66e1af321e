#include "render/frame/preview_correction.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/parallel.h"
#include "common/base/tuned.h"
#include "render/estimators/light_groups.h"
#include "render/frame/film_parts.h"
#include "render/frame/frame_loop.h"
#include "render/frame/pixel_width.h"
#include "render/frame/sample_pilot.h"

namespace shadowcache {

namespace {

/// Pixels of the small picture.
SHADOWCACHE_TUNED(double, kCorrectionPixels, 16384);

/// Shadow rays of each.
SHADOWCACHE_TUNED(int, kCorrectionSamples, 8);

/// Side of the finest cells in which its pixels are averaged, in their widths.
SHADOWCACHE_TUNED(float, kCorrectionCell, 4);

/// Pixels that one thread takes at a time.
constexpr std::size_t kCorrectionChunk = 1024;

/// The whole of a frame in few pixels. All frames of a shot have the same random numbers, so that
/// what is left of the noise does not flicker.
FrameRequest smallFrame(const FrameRequest& frame) {
    FrameRequest small = frame;
    RenderOptions& options = small.options;
    const double shrink = std::min(
        1.0, std::sqrt(kCorrectionPixels /
                       (static_cast<double>(options.width) * static_cast<double>(options.height))));
    options.width = std::max(1, static_cast<int>(std::lround(options.width * shrink)));
    options.height = std::max(1, static_cast<int>(std::lround(options.height * shrink)));
    options.crop = {};
    options.cameraRays = 1;
    options.insight = false;
    small.number = 0;
    small.tileRays.clear();
    small.plan = {};
    return small;
}

Film filmOf(const FrameRequest& frame, RenderStats& stats) {
    Film film = makeFilm(frame.options, frame.estimator.context().groups);
    renderTiles(frame, Tiles(frame.options).touching(frame.options.region()),
                BlockExtent::wholeFrame, stats,
                {.onTile = [&](const RenderedTile& tile) { placePixels(tile, film); }});
    return film;
}

/// Irradiance by other surfaces; 0 on black, which does not show it.
Rgb indirectIrradiance(const Pixel& pixel) {
    Rgb irradiance(0, 0, 0);
    for (int k = 0; k < 3; ++k)
        if (pixel.diffuseAlbedo[k] > 0)
            irradiance[k] =
                static_cast<float>(kPi) * pixel.diffuseIndirect[k] / pixel.diffuseAlbedo[k];
    return irradiance;
}

Rgb atLeastZero(const Rgb& c) {
    return {std::max(0.0f, c.x), std::max(0.0f, c.y), std::max(0.0f, c.z)};
}

/// Light of the same pixel without rays and with them.
CheckedPlace checkedPlace(const Pixel& predicted, const Pixel& found) {
    const Rgb indirect[] = {indirectIrradiance(predicted), indirectIrradiance(found)};
    return {.direct = {predicted.irradiance - indirect[0], found.irradiance - indirect[1]},
            .indirect = {indirect[0], indirect[1]}};
}

/// Adds light to some groups, in proportion to theirs or, where they have none, to the frame's.
void addInProportion(const Rgb& added, std::span<const Rgb> ofFrame, std::span<Rgb> groups) {
    for (int k = 0; k < 3; ++k) {
        float own = 0, all = 0;
        for (std::size_t g = 0; g < groups.size(); ++g) {
            own += groups[g][k];
            all += ofFrame[g][k];
        }
        for (std::size_t g = 0; g < groups.size(); ++g)
            if (own > 0)
                groups[g][k] += added[k] * (groups[g][k] / own);
            else if (all > 0)
                groups[g][k] += added[k] * (ofFrame[g][k] / all);
    }
}

CheckedLight operator*(const CheckedLight& light, const Rgb& factor) {
    return {light.predicted * factor, light.found * factor};
}

/// Corrects what a pixel shows reflected, but for gloss.
/// @return what that adds to it
Rgb correctPixel(const CheckedPlace& check, Pixel& pixel) {
    const Rgb reflectance = pixel.diffuseAlbedo * static_cast<float>(1 / kPi);
    const Rgb direct = (check.direct * reflectance).correct(pixel.diffuse - pixel.diffuseIndirect);
    const Rgb indirect = (check.indirect * reflectance).correct(pixel.diffuseIndirect);
    const Rgb added = direct + indirect - pixel.diffuse;
    const CheckedLight all{check.direct.predicted + check.indirect.predicted,
                           check.direct.found + check.indirect.found};
    pixel.irradiance = (all * Rgb(pixel.coverage)).correct(pixel.irradiance);
    pixel.diffuse = direct + indirect;
    pixel.diffuseIndirect = indirect;
    pixel.color += added;
    return added;
}

}  // namespace

PreviewCorrection::PreviewCorrection(const FrameRequest& frame, RenderStats& stats)
    : learnt_(learn(frame, stats)) {}

PreviewCorrection::Learnt PreviewCorrection::learn(const FrameRequest& frame, RenderStats& stats) {
    FrameRequest small = smallFrame(frame);
    const Film predicted = filmOf(small, stats);
    small.options.samples = kCorrectionSamples;
    small.plan = planSamples(small, stats);
    const Film estimated = filmOf(small, stats);

    std::vector<CorrectionField::Place> places;
    std::vector<float> widths;
    for (std::size_t i = 0; i < estimated.pixels.size(); ++i) {
        const Pixel& pixel = estimated.pixels[i];
        const float length = pixel.normal.length();
        if (!(pixel.coverage > 0 && length > 0 && isFinite(pixel))) continue;
        places.push_back(
            {pixel.position, pixel.normal / length, checkedPlace(predicted.pixels[i], pixel)});
        widths.push_back(pixelWidth(small.camera.open, small.options, pixel.depth));
    }
    float width = 0;
    if (!widths.empty()) {
        const auto middle = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / 2);
        std::ranges::nth_element(widths, middle);
        width = *middle;
    }
    if (!(width > 0)) width = 1;  // nothing is seen, or the lens touches it
    std::vector<Rgb> groups(estimated.groups.size(), Rgb(0, 0, 0));
    for (std::size_t i = 0; !groups.empty() && i < estimated.pixels.size(); ++i)
        for (std::size_t g = 0; g < groups.size(); ++g)
            groups[g] += atLeastZero(estimated.groupColors[i][g]);
    return {CorrectionField(places, kCorrectionCell * width), std::move(groups)};
}

void PreviewCorrection::correct(Film& film) const {
    parallelFor(film.pixels.size(), kCorrectionChunk, [&](const Chunk& chunk) {
        for (std::size_t i = chunk.begin; i < chunk.end; ++i) {
            Pixel& pixel = film.pixels[i];
            const float length = pixel.normal.length();
            if (!(pixel.coverage > 0 && length > 0)) continue;
            const CheckedPlace check =
                learnt_.field.at(pixel.position / pixel.coverage, pixel.normal / length);
            const Rgb added = correctPixel(check, pixel);
            if (!film.groups.empty()) addInProportion(added, learnt_.groups, film.groupColors[i]);
        }
    });
}

}  // namespace shadowcache
