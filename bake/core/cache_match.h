#pragma once

#include <filesystem>
#include <sstream>
#include <string>

#include "common/base/error.h"

namespace shadowcache {

/// Refuses a cache that differs from what is wanted.
///
/// @param what    names the value
/// @param reason  why it is wanted, as in "as in the first cache"
/// @throws Error naming the file, the value found and the value wanted
template <class T>
void requireSame(const std::filesystem::path& path, const char* what, const T& found,
                 const T& wanted, const char* reason) {
    if (found == wanted) return;
    std::ostringstream text;
    text.precision(15);
    text << what << ' ' << found << ", expected " << wanted << ' ' << reason;
    throwFileError(path, text.str());
}

}  // namespace shadowcache
