#pragma once

#include <csignal>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/base/exit_status.h"

namespace shadowcache::test {

/// What came of running a program.
struct ProgramRun {
    int status = 0;  ///< exit status, or 128 + the signal that ended it
    std::string out, err;
};

/// What a program runs under.
struct RunLimits {
    std::optional<std::size_t> fileBytes{};  ///< longest file it may write, as a full disk does
    std::function<bool()> interruptWhen{};   ///< asked until it holds: Ctrl-C comes then
    int signal = SIGINT;                     ///< in place of Ctrl-C
    std::filesystem::path input{};           ///< a file that is its standard input
    bool nobody = false;                     ///< if root runs it: permissions hold for it then
    bool standardBounces = false;            ///< without it, light bounces only if asked to
};

/// What holds from some time after it was asked first, for RunLimits::interruptWhen.
std::function<bool()> afterSeconds(double seconds);

/// Starts one of the project's programs in `folder`, and kills it with SIGKILL after a while.
///
/// @return whether it was still running
bool runAndKill(const std::string& name, const std::vector<std::string>& arguments,
                const std::filesystem::path& folder, double seconds);

/// Runs one of the project's programs ("bake", "render", "farm", "info", "merge", "make-set") in
/// `folder` to its end. Each of its two outputs must fit a pipe (64 kB). "render" shows direct
/// light alone, which most tests are about, unless --bounces or --mix is among the arguments, or
/// the limits say so.
ProgramRun runProgram(const std::string& name, const std::vector<std::string>& arguments,
                      const std::filesystem::path& folder, const RunLimits& limits = {});

/// The file of one of the programs.
const std::string& programPath(const std::string& name);

/// The folders of the programs, as in PATH.
std::string programFolders();

/// Names of what stands in a folder, sorted.
std::vector<std::string> filesIn(const std::filesystem::path& folder);

/// The words of a command line.
std::vector<std::string> words(const std::string& line);

/// Expects that the run failed in one line on standard error that begins with the program's name
/// and holds both texts.
void expectRefusal(const ProgramRun& run, const std::string& program, const std::string& first,
                   const std::string& second = "", int status = kFailed);

}  // namespace shadowcache::test
