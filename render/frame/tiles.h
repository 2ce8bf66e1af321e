#pragma once

#include <cstddef>
#include <vector>

#include "render/frame/options.h"

namespace shadowcache {

/// A pixel's place on the film.
struct FilmPlace {
    int x, y;

    bool operator==(const FilmPlace&) const = default;
};

/// The tiles of a frame, row by row: squares of pixels with ragged borders, which are lit together.
/// Every pixel belongs to one, near its square or in it.
class Tiles {
public:
    /// Whole frame, whatever is cropped.
    explicit Tiles(const RenderOptions& options);

    std::size_t count() const {
        return static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_);
    }

    /// Number of the tile that a pixel belongs to.
    std::size_t tileOf(int x, int y) const;

    /// The pixels of a tile along a Morton curve, so that a run of them is a compact patch.
    void findPlaces(std::size_t tile, std::vector<FilmPlace>& places) const;

    /// Those with a pixel in the rectangle, in order.
    std::vector<std::size_t> touching(const FilmRectangle& rectangle) const;

private:
    int width_, height_, across_, down_;
};

}  // namespace shadowcache
