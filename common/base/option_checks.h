#pragma once

#include <filesystem>
#include <sstream>
#include <string>

#include "common/base/error.h"

namespace shadowcache {

inline constexpr int kMaxThreads = 4096;

/// Refuses an option's value out of [least, most], NaN included.
///
/// @throws Error "--NAME VALUE: wanted LEAST to MOST"
template <class T>
void requireRange(const char* name, T value, T least, T most) {
    if (value >= least && value <= most) return;
    std::ostringstream text;
    text << "--" << name << ' ' << value << ": wanted " << least << " to " << most;
    throw Error(text.str());
}

/// Refuses an output whose name would tell other programs a wrong format; it may also be a slip
/// that would overwrite an input.
///
/// @throws Error naming the file and the extension wanted
inline void requireExtension(const std::filesystem::path& path, const char* extension) {
    if (path.extension() != extension)
        throwFileError(path, std::string("wanted an output whose name ends in ") + extension);
}

}  // namespace shadowcache
