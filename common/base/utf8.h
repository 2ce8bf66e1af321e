#pragma once

#include <string>
#include <string_view>

namespace shadowcache {

/// Replaces bytes that are not UTF-8 by U+FFFD.
///
/// @param mended  receives the text, unless all of it is UTF-8
/// @return whether there were any
bool mendUtf8(std::string_view text, std::string& mended);

}  // namespace shadowcache
