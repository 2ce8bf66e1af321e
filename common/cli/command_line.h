#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/option_row.h"

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
class Option;
}  // namespace CLI

namespace shadowcache {

// What the programs' command lines share: --version, settings files, man page, completion, and
// error messages that suggest the option nearest to a mistyped one.

/// Call first. Of an option given twice the last value counts, so that
/// scripts can append to a command line.
void beginCommandLine(CLI::App& app);

/// Divides the help: --help shows the options of these groups, --help-all those of all groups.
void showInHelp(CLI::App& app, std::vector<std::string> groups);

/// Defines the options of a table, parses the command line, and reads those that were given; writes
/// the settings file if requested.
///
/// @param check  throws CLI::ParseError for errors that no single option can detect
/// @return the status to exit with if there is nothing left to do: 0 after help and version, 2 on a
/// usage error, which is printed
/// @throws Error if an option is refused, or the settings file cannot be written
std::optional<int> parseCommandLine(
    CLI::App& app, int argc, char** argv, std::span<const OptionRow> rows = {},
    const std::function<void()>& check = [] {});

/// Every option's name and value as given or defaulted, except those that do not affect the
/// result.
std::vector<std::pair<std::string, std::string>> settingsOf(const CLI::App& app);

}  // namespace shadowcache
