#pragma once

#include <cstdint>
#include <filesystem>

#include "scenes/geometry.h"

namespace shadowcache::scenes {

/// An arcaded courtyard of two storeys with a fountain, a stair, trees in pots and one furnished
/// room.
SetMesh makeCourtyard();

/// A walk along the south arcade and out into the court, toward the room's door.
std::vector<CameraKey> courtyardWalk();

/// Fewest and most triangles of the scattered set.
inline constexpr std::int64_t kScatterMin = 10'000;
inline constexpr std::int64_t kScatterMax = 10'000'000;

/// Writes a set of exactly `triangles` triangles (kScatterMin .. kScatterMax): rocks and grass on
/// rolling ground, a square whose side grows with the number, so that the density stays. Made and
/// written piece by piece.
///
/// @throws Error if the number is out of range or the file cannot be written
void writeScatter(const std::filesystem::path& path, std::int64_t triangles);

/// A move over the scattered set.
std::vector<CameraKey> scatterWalk(std::int64_t triangles);

}  // namespace shadowcache::scenes
