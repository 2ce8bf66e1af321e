#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace shadowcache {

/// The program's manual in roff, section 1, made of what --help knows.
std::string manPage(const CLI::App& app);

/// A script for bash that completes the program's options and their choices.
std::string bashCompletion(const CLI::App& app);

}  // namespace shadowcache
