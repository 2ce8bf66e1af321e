#pragma once

#include <span>
#include <string>

namespace shadowcache {

/// The known word nearest to a mistyped one, or empty if none is near.
std::string nearestWord(const std::string& typed, std::span<const std::string> known);

/// ", did you mean X?" for the known word nearest to a mistyped one, or empty.
std::string suggestion(const std::string& typed, std::span<const std::string> known);

}  // namespace shadowcache
