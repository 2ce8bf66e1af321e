#pragma once

#include <string>
#include <vector>

#include "common/farm/plan.h"

namespace shadowcache {

/// A file of a job's folder.
struct FarmFile {
    std::string name;
    std::string text;
    bool executable = false;
};

/// Who runs a job.
struct FarmScheduler {
    const char* name;    ///< the word that --for takes
    const char* submit;  ///< how the job is started, in the job's folder
    std::vector<FarmFile> (*files)(const FarmPlan&);
};

/// All that --for accepts.
const std::vector<FarmScheduler>& farmSchedulers();

// What each needs beside the script that runs a task (shell.h).
std::vector<FarmFile> slurmFiles(const FarmPlan& plan);
std::vector<FarmFile> snakemakeFiles(const FarmPlan& plan);
std::vector<FarmFile> parallelFiles(const FarmPlan& plan);
std::vector<FarmFile> openjdFiles(const FarmPlan& plan);

/// Writes the job's folder: the script and the scheduler's files.
///
/// @throws Error if the folder is of another job, or cannot be written
void writeFarm(const FarmPlan& plan, const FarmScheduler& scheduler);

}  // namespace shadowcache
