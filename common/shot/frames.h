#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace shadowcache {

/// "1-24x2" or "1,5,9-12" -> frame numbers. @throws Error that names `option`, whose text it is
std::vector<int> parseFrames(const std::string& text, const std::string& option = "--frames");

/// Output file of a frame: a run of '#' (or %0Nd) becomes the number, padded with zeros.
///
/// @throws Error if several frames would share one file
std::filesystem::path framePath(const std::filesystem::path& pattern, int frame, bool several);

}  // namespace shadowcache
