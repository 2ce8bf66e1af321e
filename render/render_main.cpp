#include <exception>

#include "common/base/exit_status.h"
#include "common/base/report_failure.h"
#include "render/app/command_line.h"
#include "render/app/mix_groups.h"
#include "render/app/run_job.h"
#include "render/serve/server.h"

int main(int argc, char** argv) try {
    using namespace shadowcache;
    installFailureHandler();
    RenderJob job;
    if (const auto status = parseArguments(argc, argv, job)) return *status;
    if (job.run.serve)
        serve(job.run.threads);
    else if (!job.run.mix.empty())
        mixGroups(job);
    else if (job.run.list)
        listSet(job);
    else
        run(job);
    return kDone;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-render", e);
}
