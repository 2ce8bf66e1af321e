#pragma once

#include <span>
#include <string>

#include "common/base/option_row.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace shadowcache {

/// The program's manual page in roff, section 1, with the same texts as --help.
std::string manPage(const CLI::App& app);

/// A script for bash that completes the program's options and their choices.
std::string bashCompletion(const CLI::App& app);

/// A table of options as JSON: an object a row, a row a line, with the names at all doors.
std::string optionsAsJson(std::span<const OptionRow> rows);

}  // namespace shadowcache
