#include "render/frame/film_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "common/base/error.h"
#include "render/estimators/light_groups.h"

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

Film makeFilm(const RenderOptions& options, const LightGroups* groups) {
    const FilmRectangle region = options.region();
    Film film{region.width,   region.height,      {}, region.x, region.y, options.width,
              options.height, options.transparent};
    film.pixels.resize(static_cast<std::size_t>(region.width) *
                       static_cast<std::size_t>(region.height));
    if (groups) {
        film.groups = groups->names();
        film.groupColors.assign(film.pixels.size(), groups->size());
    }
    return film;
}

void placePixels(const RenderedTile& tile, Film& film) {
    for (std::size_t i = 0; i < tile.places.size(); ++i) {
        const int x = tile.places[i].x - film.x, y = tile.places[i].y - film.y;
        if (x < 0 || y < 0 || x >= film.width || y >= film.height) continue;
        const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width) +
                               static_cast<std::size_t>(x);
        film.pixels[at] = tile.pixels[i];
        if (!film.groupColors.empty())
            std::ranges::copy(tile.groups[i], film.groupColors[at].begin());
    }
}

}  // namespace shadowcache
