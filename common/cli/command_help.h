#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace shadowcache {

/// The program's manual page in roff, section 1, with the same texts as --help.
std::string manPage(const CLI::App& app);

/// A script for bash that completes the program's options and their choices.
std::string bashCompletion(const CLI::App& app);

}  // namespace shadowcache
