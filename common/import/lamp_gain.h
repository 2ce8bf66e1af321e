#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/math/vec.h"
#include "common/mesh/mesh.h"

namespace shadowcache {

/// What the light of some lamps is multiplied by.
struct LampGain {
    std::string pattern;  ///< a name, in which * stands for any text
    Rgb gain{1, 1, 1};
};

/// "NAME=GAIN", the gain a factor or R,G,B, 0 to 1e6.
///
/// @throws Error naming the option
LampGain parseLampGain(const std::string& text, const std::string& option = "lamp");

bool matchesPattern(std::string_view pattern, std::string_view name);

/// The gain of what shines: of the last pattern that is its name's.
Rgb lampGainOf(std::string_view name, std::span<const LampGain> gains);

/// Has the gains be those of all that shines in a mesh.
void applyGains(std::span<const LampGain> gains, TriangleMesh& mesh);

/// Names that gains may have: of lamps, and of materials that emit.
std::vector<std::string> lampNames(const TriangleMesh& mesh);

/// @param names  of a set, as lampNames() has them
/// @throws Error naming --lamp, if a pattern matches no name
void requireMatches(std::span<const LampGain> gains, std::span<const std::string> names);

}  // namespace shadowcache
