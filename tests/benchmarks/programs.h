#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace shadowcache::bench {

/// Numbers of a --stats file by dotted key ("seconds.load").
using Stats = std::map<std::string, double>;

/// Runs one of the project's programs with --stats and reads what it wrote.
///
/// @throws Error with the program's own message if it fails
Stats runForStats(const std::string& program, std::vector<std::string> arguments,
                  const std::filesystem::path& folder);

}  // namespace shadowcache::bench
