#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace shadowcache {

/// What tells this run from all others that may write to the same disk: "PID-JOB-HOST", with the
/// job's number if a scheduler (Slurm, PBS, LSF, SGE) states one.
const std::string& runName();

/// Stands between a file's name and that of the run that writes it.
inline constexpr const char* kTemporaryMark = ".part-";

/// A new name, beside it, under which this run writes what becomes `path` when it is complete:
/// containers may share a host name, and the numbers of their processes.
std::filesystem::path temporaryPath(const std::filesystem::path& path);

/// Something that another run left.
struct Leftover {
    std::filesystem::path path;
    std::string run;  ///< its runName()
};

/// Whether the run with this runName() may still be going on: on this machine its process exists;
/// of another machine nothing is known.
bool mayBeAlive(const std::string& run);

/// Unfinished files that other runs left of `path`, by name. Those of dead runs on this machine are
/// removed, unless they are locked, as an AtomicFile is.
///
/// @param kept  receives those that may belong to a living run
/// @return what was removed
std::vector<Leftover> removeLeftovers(const std::filesystem::path& path,
                                      std::vector<Leftover>& kept);

/// removeLeftovers() for a program's output, with a line on standard output for each.
void reportLeftovers(const std::filesystem::path& path);

}  // namespace shadowcache
