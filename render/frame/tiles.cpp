#include "render/frame/tiles.h"

#include <algorithm>
#include <cstdint>

#include "common/base/hash.h"
#include "common/random/salts.h"

namespace shadowcache {

namespace {

/// Side of a tile's square: its pixels read the same cache items, and share what they find.
constexpr int kTile = 16;

/// Pixels belong to a tile up to this far from its square: what a tile shares makes its errors
/// alike, and straight borders would be seen.
constexpr int kReach = 2;

/// The bits of x and y in turns.
std::uint32_t mortonCode(std::uint32_t x, std::uint32_t y) {
    std::uint32_t code = 0;
    for (unsigned bit = 0; bit < 16; ++bit)
        code |= (x >> bit & 1u) << (2 * bit) | (y >> bit & 1u) << (2 * bit + 1);
    return code;
}

}  // namespace

Tiles::Tiles(const RenderOptions& options)
    : width_(options.width),
      height_(options.height),
      across_((options.width + kTile - 1) / kTile),
      down_((options.height + kTile - 1) / kTile) {}

std::size_t Tiles::tileOf(int x, int y) const {
    const std::uint64_t hash = hashWords(FrameSalt::tileBorder, static_cast<std::uint64_t>(x),
                                         static_cast<std::uint64_t>(y));
    const auto shaken = [&](int place, int shift, int tiles) {
        const int shake = static_cast<int>(hash >> shift & 0xffff) * (2 * kReach + 1) >> 16;
        return std::clamp((place + shake - kReach + kTile) / kTile - 1, 0, tiles - 1);
    };
    return static_cast<std::size_t>(shaken(y, 16, down_)) * static_cast<std::size_t>(across_) +
           static_cast<std::size_t>(shaken(x, 0, across_));
}

void Tiles::findPlaces(std::size_t tile, std::vector<FilmPlace>& places) const {
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

std::vector<std::size_t> Tiles::touching(const FilmRectangle& rectangle) const {
    std::vector<bool> touched(count());
    for (int y = rectangle.y; y < rectangle.y + rectangle.height; ++y)
        for (int x = rectangle.x; x < rectangle.x + rectangle.width; ++x)
            touched[tileOf(x, y)] = true;
    std::vector<std::size_t> tiles;
    for (std::size_t t = 0; t < touched.size(); ++t)
        if (touched[t]) tiles.push_back(t);
    return tiles;
}

}  // namespace shadowcache
