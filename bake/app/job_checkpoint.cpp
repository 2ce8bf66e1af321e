#include "bake/app/job_checkpoint.h"

#include <cstdint>
#include <cstdio>
#include <limits>

#include "common/base/interrupt.h"

namespace shadowcache {

std::unique_ptr<Checkpoint> startCheckpoint(const BakeJob& job, const BakeIdentity& identity) {
    const std::uint64_t memory =
        job.memory > 0 ? job.memory : std::numeric_limits<std::uint64_t>::max();
    auto checkpoint =
        std::make_unique<Checkpoint>(job.output, identity, job.checkpointSeconds, memory);
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
