#pragma once

#include <cstdint>
#include <span>

#include "render/frame/film.h"
#include "render/frame/options.h"
#include "render/frame/tiles.h"

namespace shadowcache {

/// A film for the region that is rendered.
Film makeFilm(const RenderOptions& options);

/// Puts those pixels of a tile that the film has in their places.
void placePixels(std::span<const FilmPlace> places, std::span<const Pixel> pixels, Film& film);

/// A picture with a hole is worse than none.
///
/// @throws Error saying how many pixels are not finite and how to replay the first
void requireFinite(const Film& film, int frame, std::uint64_t seed);

}  // namespace shadowcache
