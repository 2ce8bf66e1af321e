#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/option_row.h"

namespace shadowcache {

// What the programs' command lines share: --version, settings files, man page, completion, and
// error messages that suggest the option nearest to a mistyped one. Only this room includes CLI11,
// which takes seconds to compile.

/// A command line, apart from its options.
struct CommandLine {
    std::string program;
    std::string summary;  ///< what the program does, a sentence
    std::string footer;   ///< of the help: examples
    /// Groups whose options --help shows, where --help-all shows those of all groups; empty: --help
    /// shows all.
    std::vector<std::string> groupsInHelp{};
};

/// What a command line says.
struct ParsedLine {
    /// The status to exit with if there is nothing left to do: 0 after help and version, 2 after a
    /// usage error, which has been printed.
    std::optional<int> status;
    std::vector<std::string> given;  ///< the options that were given, as "--NAME"
    /// Every option's name and value as given or defaulted, except those that do not affect the
    /// result.
    std::vector<std::pair<std::string, std::string>> settings;

    bool isGiven(const std::string& option) const;
};

/// Defines the options of a table, parses the command line, and reads those that were given; writes
/// the settings file if requested. Of an option given twice the last value counts, so that scripts
/// can append to a command line.
///
/// @param check  throws FormError for usage errors that no single option can detect
/// @throws Error if an option is refused, or the settings file cannot be written
ParsedLine parseCommandLine(
    const CommandLine& line, int argc, char** argv, std::span<const OptionRow> rows,
    const std::function<void(const ParsedLine&)>& check = [](const ParsedLine&) {});

}  // namespace shadowcache
