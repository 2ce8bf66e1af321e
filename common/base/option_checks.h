#pragma once

#include <filesystem>
#include <string>

#include "common/base/error.h"
#include "common/base/text_streams.h"

namespace shadowcache {

inline constexpr int kMaxThreads = 4096;

/// Refuses an option's value out of [least, most], NaN included.
///
/// @throws Error "--NAME VALUE: expected LEAST to MOST"
template <class T>
void requireRange(const char* name, T value, T least, T most) {
    if (value >= least && value <= most) return;
    TextWriter text;
    text << "--" << name << ' ' << value << ": expected " << least << " to " << most;
    throw Error(text.str());
}

/// Refuses an output whose extension would suggest a wrong format to other programs; it may also be
/// a mistake that would overwrite an input.
///
/// @throws Error naming the file and the extension wanted
inline void requireExtension(const std::filesystem::path& path, const char* extension) {
    if (path.extension() != extension)
        throwFileError(
            path,
            std::string("is not a name for this output, expected one that ends in ") + extension);
}

}  // namespace shadowcache
