#pragma once

#include <filesystem>
#include <string>

#include "common/base/error.h"
#include "common/base/text_streams.h"

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
    TextWriter text;
    text.precision(15);
    text << what << ' ' << found << ", expected " << wanted << ' ' << reason;
    throwFileError(path, text.str());
}

}  // namespace shadowcache
