#pragma once

#include <cstdint>
#include <filesystem>

#include "scenes/geometry.h"

namespace shadowcache::scenes {

/// An arcaded courtyard of two storeys with a fountain, a stair, trees in pots and one furnished
/// room.
SetMesh makeCourtyard();

/// The courtyard with lanterns in its arcades, a lamp over the room's table and a pane in the
/// room's window. To be written as glTF, which has lamps and panes.
SetMesh makeNight();

/// A move in the room, past the table.
std::vector<CameraKey> nightWalk();

/// A walk along the south arcade and out into the court, toward the room's door.
std::vector<CameraKey> courtyardWalk();

/// A room whose only light comes between the slats of a blind.
SetMesh makeBlinds();
/// A move at the back of the room.
std::vector<CameraKey> blindsWalk();

/// A house of panes with plants, on a meadow. To be written as glTF, which has panes.
SetMesh makeGreenhouse();
/// A move along its aisle.
std::vector<CameraKey> greenhouseWalk();

/// A path between clipped hedges and trees: leaves on every side.
SetMesh makeHedges();
/// A move along the path.
std::vector<CameraKey> hedgesWalk();

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
