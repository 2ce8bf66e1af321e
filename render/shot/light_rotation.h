#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/math/turn.h"

namespace shadowcache {

/// How a map is turned, as a user says it; Environment::turn() does it
/// (common/light/environment.h).
struct LightRotation {
    /// One: degrees about +Y; three: degrees about +X, then +Y, then +Z (turnByAngles); nine: the
    /// rows of an orthogonal matrix that takes directions of the map to those of the world.
    std::vector<double> numbers{0};

    Turn turn() const;
    /// The numbers, joined by commas, such that they read back.
    std::string text() const;

    bool operator==(const LightRotation&) const = default;
};

/// First and last of a shot.
struct LightRotations {
    LightRotation first, last;
};

/// "A", "A-B" (from A in the first frame to B in the last), "X,Y,Z" or nine numbers.
///
/// @throws Error if `text` is none of these, or the matrix is not orthogonal
LightRotations parseRotation(const std::string& text);

/// Numbers joined by commas, finite; empty if `text` is not such a list.
std::vector<double> parseNumbers(const std::string& text);

}  // namespace shadowcache
