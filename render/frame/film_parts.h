#pragma once

#include <cstdint>

#include "render/frame/film.h"
#include "render/frame/frame_loop.h"
#include "render/frame/options.h"

namespace shadowcache {

/// A film for the region that is rendered.
///
/// @param groups  whose light it keeps apart; may be null
Film makeFilm(const RenderOptions& options, const LightGroups* groups = nullptr);

/// Puts those pixels of a tile that the film has in their places.
void placePixels(const RenderedTile& tile, Film& film);

/// A picture with a hole is worse than none.
///
/// @throws Error saying how many pixels are not finite and how to replay the first
void requireFinite(const Film& film, int frame, std::uint64_t seed);

}  // namespace shadowcache
