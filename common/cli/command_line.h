#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {  // NOLINT(readability-identifier-naming)
class App;
class Option;
}  // namespace CLI

namespace shadowcache {

// What the programs' command lines share: --version, settings files, man page, completion, and
// error messages that suggest the option nearest to a mistyped one. Each program defines its own
// options, with those of options.h among them.

/// Call before the options are defined. Of an option given twice the last value counts, so that
/// scripts can append to a command line.
void beginCommandLine(CLI::App& app);

/// Divides the help: --help shows the options of these groups, --help-all those of all groups.
void showInHelp(CLI::App& app, std::vector<std::string> groups);

/// Parses the command line once all options are defined; writes the settings file if requested.
///
/// @param check  throws CLI::ParseError for errors that no single option can detect
/// @return the status to exit with if there is nothing left to do: 0 after help and version, 2 on a
/// usage error, which is printed
/// @throws Error if the settings file cannot be written
std::optional<int> parseCommandLine(
    CLI::App& app, int argc, char** argv, const std::function<void()>& check = [] {});

/// A size in bytes: a number above 0 with or without K, M, G or T (of 1024), as in 4G, 1.5G, 512MB.
///
/// @throws Error "OPTION TEXT: expected ..."
std::uint64_t parseSize(const char* option, const std::string& text);

/// "AxB" or "A,B" -> two whole numbers of 0 or more.
///
/// @throws Error "OPTION TEXT: expected WANTED"
std::array<int, 2> parsePair(const char* option, const std::string& text, const char* wanted);

/// Every option's name and value as given or defaulted, except those that do not affect the
/// result.
std::vector<std::pair<std::string, std::string>> settingsOf(const CLI::App& app);

}  // namespace shadowcache
