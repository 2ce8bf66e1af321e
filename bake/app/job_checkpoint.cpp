#include "bake/app/job_checkpoint.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string_view>

#include "common/base/interrupt.h"
#include "common/base/leftovers.h"
#include "common/base/version.h"
#include "common/import/set_files.h"

namespace shadowcache {

namespace {

/// Options that items do not depend on, or that identityOf() states by content.
constexpr std::string_view kNotOfTheItems[] = {"SET",     "output",   "stats",      "threads",
                                               "resume",  "extend",   "checkpoint", "camera",
                                               "dynamic", "progress", "memory"};

/// All that the items of the job's cache depend on.
BakeIdentity identityOf(const BakeJob& job) {
    BakeIdentity identity{{"version", kVersion},
                          {"set", contentHashOf(job.files, job.mesh.references)}};
    // Where things are read from and written to is no part of it; what is read is.
    for (const auto& [name, value] : job.settings)
        if (std::ranges::find(kNotOfTheItems, name) == std::end(kNotOfTheItems))
            identity.emplace_back(name, value);
    const std::filesystem::path camera = job.shot.camera.name;
    identity.emplace_back("camera", camera.filename().string());
    std::vector<std::filesystem::path> moving{camera};
    for (const DynamicFile& file : job.shot.dynamic) {
        moving.push_back(file.mesh);
        moving.push_back(file.track);
    }
    identity.emplace_back("shot's files", contentHashOf(moving, job.mesh.references));
    identity.emplace_back("extended cache",
                          contentHashOf(std::vector{job.extend}, job.mesh.references));
    return identity;
}

}  // namespace

std::unique_ptr<Checkpoint> startCheckpoint(const BakeJob& job) {
    reportLeftovers(job.output);
    const std::uint64_t memory =
        job.memory > 0 ? job.memory : std::numeric_limits<std::uint64_t>::max();
    auto checkpoint =
        std::make_unique<Checkpoint>(job.output, identityOf(job), job.checkpointSeconds, memory);
    const char* folder = checkpoint->folder().c_str();
    if (job.resume) {
        if (const std::size_t regions = checkpoint->resume())
            std::printf("%s: %zu regions are finished\n", folder, regions);
    } else if (checkpoint->discardOthers() > 0) {
        std::printf("%s: removed what an interrupted bake had left (--resume would continue it)\n",
                    folder);
    }
    return checkpoint;
}

BakeResult bakeOrKeep(const Scene& scene, const BakeOptions& options,
                      const VoxelSelection& selection, Checkpoint& checkpoint) {
    try {
        return bake(scene, options, selection, &checkpoint);
    } catch (const Interrupted&) {
        if (checkpoint.flush() && checkpoint.regions() > 0)
            std::printf("%s: %zu regions are kept; the same command with --resume continues\n",
                        checkpoint.folder().c_str(), checkpoint.regions());
        throw;
    }
}

}  // namespace shadowcache
