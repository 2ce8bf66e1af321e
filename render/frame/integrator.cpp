#include "render/frame/integrator.h"

#include <algorithm>
#include <string>

#include "common/base/error.h"
#include "common/base/progress.h"
#include "common/base/salts.h"
#include "common/base/hash.h"
#include "render/frame/tile_loop.h"

namespace shadowcache {

namespace {

/// A picture with a hole is worse than none: says how many pixels failed and how to replay one.
void requireFinite(const Film& film, int frame, std::uint64_t seed) {
    const auto failed = [](const Pixel& p) { return !isFinite(p); };
    const auto first = std::find_if(film.pixels.begin(), film.pixels.end(), failed);
    if (first == film.pixels.end()) return;
    const auto i = first - film.pixels.begin();
    throw Error("frame " + std::to_string(frame) + ": " +
                std::to_string(std::count_if(first, film.pixels.end(), failed)) +
                " pixels without a finite estimate; replay the first with --debug " +
                std::to_string(film.x + i % film.width) + "," +
                std::to_string(film.y + i / film.width) +
                (frame == 1 ? "" : " --frames " + std::to_string(frame)) + " --seed " +
                std::to_string(seed));
}

/// A film for the region that is rendered.
Film makeFilm(const RenderOptions& options) {
    const FilmRectangle region = options.region();
    Film film{region.width, region.height, {}, region.x, region.y, options.width, options.height};
    film.pixels.resize(static_cast<std::size_t>(region.width) *
                       static_cast<std::size_t>(region.height));
    return film;
}

/// Puts the pixels that the film has in their places.
void place(std::span<const FilmPlace> places, std::span<const Pixel> pixels, Film& film) {
    for (std::size_t i = 0; i < places.size(); ++i) {
        const int x = places[i].x - film.x, y = places[i].y - film.y;
        if (x < 0 || y < 0 || x >= film.width || y >= film.height) continue;
        film.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width) +
                    static_cast<std::size_t>(x)] = pixels[i];
    }
}

}  // namespace

Film render(const FrameRequest& frame, RenderStats& stats) {
    const RenderOptions& options = frame.options;
    Film film = makeFilm(options);
    const std::vector<std::size_t> tiles = Tiles(options).touching(options.region());
    Progress progress("frame " + std::to_string(frame.number), tiles.size());
    renderTiles(frame, tiles, stats, [&](const TileTurn& turn, std::span<const Pixel> pixels) {
        place(turn.places, pixels, film);
        progress.add(1);
    });
    requireFinite(film, frame.number, options.seed);
    return film;
}

std::vector<Pixel> renderSomeTiles(const FrameRequest& frame, int apart, RenderStats& stats) {
    const RenderOptions& options = frame.options;
    const std::vector<std::size_t> all = Tiles(options).touching(options.region());
    std::vector<std::size_t> some;
    const auto step = static_cast<std::size_t>(apart);
    for (std::size_t t = 0; t < all.size(); t += step)
        some.push_back(all[std::min(t + hashWords(options.seed, FrameSalt::someTiles, t) % step,
                                    all.size() - 1)]);
    std::vector<std::vector<Pixel>> parts(some.size());
    renderTiles(frame, some, stats, [&](const TileTurn& turn, std::span<const Pixel> pixels) {
        parts[turn.index].assign(pixels.begin(), pixels.end());
    });
    std::vector<Pixel> found;
    for (const auto& part : parts) found.insert(found.end(), part.begin(), part.end());
    return found;
}

Pixel renderPixel(const FrameRequest& frame, int x, int y, const CameraSampleObserver& observer) {
    TileRenderer renderer(frame);
    renderer.observe(x, y, observer);
    const auto workspace = frame.estimator.makeWorkspace();
    TileScratch scratch;
    std::vector<FilmPlace> places;
    const Tiles tiles(frame.options);
    tiles.findPlaces(tiles.tileOf(x, y), places);
    std::vector<PixelSum> sums(places.size());
    renderer.renderTile(places, scratch, *workspace, sums);
    const auto place =
        std::ranges::find_if(places, [&](const FilmPlace& p) { return p.x == x && p.y == y; });
    return renderer.average(sums[static_cast<std::size_t>(place - places.begin())]);
}

}  // namespace shadowcache
