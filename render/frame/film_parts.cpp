#include "render/frame/film_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "common/base/error.h"

namespace shadowcache {

void requireFinite(const Film& film, int frame, std::uint64_t seed) {
    const auto failed = [](const Pixel& p) { return !isFinite(p); };
    const auto first = std::find_if(film.pixels.begin(), film.pixels.end(), failed);
    if (first == film.pixels.end()) return;
    const auto i = first - film.pixels.begin();
    throw Error(fmt::format(
        "frame {}: {} pixels without a finite estimate; replay the first with --debug {},{}{} "
        "--seed {}",
        frame, std::count_if(first, film.pixels.end(), failed), film.x + i % film.width,
        film.y + i / film.width, frame == 1 ? "" : fmt::format(" --frames {}", frame), seed));
}

Film makeFilm(const RenderOptions& options) {
    const FilmRectangle region = options.region();
    Film film{region.width,   region.height,      {}, region.x, region.y, options.width,
              options.height, options.transparent};
    film.pixels.resize(static_cast<std::size_t>(region.width) *
                       static_cast<std::size_t>(region.height));
    return film;
}

void placePixels(std::span<const FilmPlace> places, std::span<const Pixel> pixels, Film& film) {
    for (std::size_t i = 0; i < places.size(); ++i) {
        const int x = places[i].x - film.x, y = places[i].y - film.y;
        if (x < 0 || y < 0 || x >= film.width || y >= film.height) continue;
        film.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width) +
                    static_cast<std::size_t>(x)] = pixels[i];
    }
}

}  // namespace shadowcache
