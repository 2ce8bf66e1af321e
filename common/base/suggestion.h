#pragma once

#include <span>
#include <string>

namespace shadowcache {

/// The known word that a mistyped one most likely stands for, or empty if none is near.
std::string nearestWord(const std::string& typed, std::span<const std::string> known);

/// What an error adds about a mistyped word: ", did you mean X?" or nothing.
std::string suggestion(const std::string& typed, std::span<const std::string> known);

}  // namespace shadowcache
