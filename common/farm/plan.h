#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace shadowcache {

// A shot on a farm as one value: steps of tasks, each step after the one before it. What a
// scheduler reads is made of it (farm_files.h).

/// A word of a command line; `varies`: the task's value stands between its two texts.
struct FarmWord {
    std::string text;
    bool varies = false;
    std::string after = {};

    /// The word of the task with this value.
    std::string with(const std::string& value) const;
};

/// Tasks that can run at the same time; each starts when all tasks of the step before are done.
struct FarmStep {
    std::string name;     ///< letters only
    std::string program;  ///< "shadowcache-bake"
    std::vector<FarmWord> arguments;
    std::vector<std::string> values;  ///< one a task, at least one: "3", "11-20"
    /// File that a task leaves complete or not at all: where it is there the task is done. Empty:
    /// the program finds out for itself.
    FarmWord product = {};
    /// Files, and folders of caches; the product is made again if one of them is newer.
    std::vector<std::filesystem::path> sources = {};

    /// Arguments of task `index`, from 0.
    std::vector<std::string> argumentsOf(std::size_t index) const;
};

struct FarmPlan {
    std::filesystem::path folder;  ///< of the job, absolute
    std::filesystem::path
        work;              ///< folder that relative paths of the command lines start from, absolute
    std::string programs;  ///< folders of the programs, absolute, joined by ':'
    int threads = 0;       ///< of a task; 0: all cores of its machine
    std::vector<FarmStep> steps;  ///< in their order
};

/// What is asked of a farm.
struct FarmJob {
    std::vector<std::string> set;                ///< files and options that bake and render share
    std::vector<std::filesystem::path> sources;  ///< files among these
    std::vector<std::string> bakeOnly;           ///< further options of shadowcache-bake
    std::vector<std::string> renderOnly;         ///< further options of shadowcache-render
    std::vector<int> frames;                     ///< at least one
    int shards = 1;                              ///< of the bake, 1 to kMostShards
    int chunk = 10;                              ///< frames of a render task, 1 or more
    std::string pictures;  ///< EXR with a frame number; empty: in the job's folder
};

constexpr int kMostShards = 10000;

/// Frames as --frames reads them: "7", "1-10", "1-19x2" or "1,5,6".
///
/// @param frames  at least one
std::string framesText(const std::vector<int>& frames);

/// Lookups, bakes, merge, frames, check.
///
/// @param place  folders and threads; its steps are not read
/// @throws Error naming the option if `job` is out of range
FarmPlan makePlan(const FarmJob& job, FarmPlan place);

}  // namespace shadowcache
