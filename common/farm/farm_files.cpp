#include "common/farm/farm_files.h"

#include "common/base/atomic_file.h"
#include "common/base/error.h"
#include "common/base/file_bytes.h"
#include "common/farm/shell.h"

namespace shadowcache {

namespace {

void writeText(const std::filesystem::path& path, const FarmFile& content) {
    writeWhole(path, content.text);
    if (content.executable)
        std::filesystem::permissions(path,
                                     std::filesystem::perms::owner_exec |
                                         std::filesystem::perms::group_exec |
                                         std::filesystem::perms::others_exec,
                                     std::filesystem::perm_options::add);
}

/// A folder may be written again by the same command line, for another scheduler, too: what is done
/// stays done. Parts of another job in it would be taken for this one's.
void refuseOtherJobs(const std::filesystem::path& script, const std::string& text) {
    std::error_code ignored;
    if (!std::filesystem::exists(script, ignored) || readFileBytes(script) == text) return;
    throwFileError(script, "of another job, expected an empty folder or one of this job");
}

}  // namespace

const std::vector<FarmScheduler>& farmSchedulers() {
    static const std::vector<FarmScheduler> all{
        {"slurm", "submit [OPTIONS of sbatch]", slurmFiles},
        {"snakemake", "submit [OPTIONS of snakemake]", snakemakeFiles},
        {"parallel", "submit [OPTIONS of parallel]", parallelFiles},
        {"openjd", "openjd.json is the job's template", openjdFiles}};
    return all;
}

void writeFarm(const FarmPlan& plan, const FarmScheduler& scheduler) {
    const FarmFile script{"run", runScript(plan), true};
    std::vector<FarmFile> files = scheduler.files(plan);
    files.push_back(script);
    try {
        for (const char* name : {"parts", "frames", "log"})
            std::filesystem::create_directories(plan.folder / name);
    } catch (const std::filesystem::filesystem_error& e) {
        throwFileError(plan.folder, "cannot be created: " + e.code().message());
    }
    refuseOtherJobs(plan.folder / script.name, script.text);
    for (const FarmFile& file : files) writeText(plan.folder / file.name, file);
}

}  // namespace shadowcache
