#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
}

namespace shadowcache {

// What the programs' command lines share: --version, a settings file, man page and completion, and
// errors that name the option that was meant. Options are the programs' own.

/// Before the program defines its options. Of an option given twice the last one counts, so that
/// scripts can add to a command line.
void beginCommandLine(CLI::App& app);

/// Parses the command line once all options are defined; writes the settings file if asked to.
///
/// @param check  throws CLI::ParseError for what no single option can see
/// @return the status to exit with if there is nothing left to do: help, version, wrong usage
/// @throws Error if the settings file cannot be written
std::optional<int> parseCommandLine(
    CLI::App& app, int argc, char** argv, const std::function<void()>& check = [] {});

/// A size in bytes: a number above 0 with or without K, M, G or T (of 1024), as in 4G, 1.5G, 512MB.
///
/// @throws Error "OPTION TEXT: wanted ..."
std::uint64_t parseSize(const char* option, const std::string& text);

/// What is wrong with the text of a whole number from 0 up, for CLI::Option::check: CLI11 would
/// turn -1 into 2^64 - 1.
std::string notNegative(const std::string& text);

/// Every option's name and value as given or defaulted, but for those that steer no work.
std::vector<std::pair<std::string, std::string>> settingsOf(const CLI::App& app);

}  // namespace shadowcache
