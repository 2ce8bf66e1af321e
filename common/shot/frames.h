#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace shadowcache {

/// "1-24x2", "1,5,9-12" or "-8--1" -> frame numbers. @throws Error that names `option`, whose text
/// it is
std::vector<int> parseFrames(const std::string& text, const std::string& option = "--frames");

/// Whether the name of a file has a place for the number of a frame: a run of '#', or %d, %4d,
/// %04d.
bool hasFrameNumber(const std::string& name);

/// Which frames a name of a file stands for.
enum class FrameNames {
    unasked,  ///< a picture for which nobody gave a frame: a single '#' in its name is no number
    one,
    several,
};

/// Output file of a frame: the last run of '#' (or %0Nd) becomes the number, padded with zeros, its
/// sign before them; of the N characters of %0Nd it is one, as printf() counts.
///
/// @throws Error if several frames would share one file
std::filesystem::path framePath(const std::filesystem::path& pattern, int frame, FrameNames names);

}  // namespace shadowcache
