#pragma once

#include <filesystem>
#include <optional>

#include "common/import/mesh_options.h"
#include "common/math/affine.h"
#include "common/mesh/lamp.h"

namespace shadowcache {

/// Light of a lamp, at most: sums of more would not be finite.
inline constexpr double kMostLampStrength = 1e15;

/// A lamp as a map puts it into the world. Scale changes the size of areas alone, and leaves their
/// intensity. None: it has no direction there.
std::optional<Lamp> placedLamp(Lamp lamp, const Affine& toWorld);

/// A lamp in another unit of length, in which the set looks the same.
///
/// @param unit  length of the lamp's unit in the other
void changeUnit(Lamp& lamp, double unit);

/// A lamp of a file as a set has it: in the world, in its unit, with its gain.
///
/// @throws Error naming the file and the lamp, if that is out of reach
Lamp lampOfSet(const std::filesystem::path& file, const Lamp& lamp, const MeshOptions& options);

/// A lamp of a set as a track moves it in the world; one that it scales to nothing has a gain of 0.
///
/// @throws Error as lampOfSet()
Lamp trackedLamp(const std::filesystem::path& file, const Lamp& lamp, const Affine& track);

/// Whether a lamp that moves is there: it is not scaled to nothing.
bool hasSize(const Affine& place);

}  // namespace shadowcache
