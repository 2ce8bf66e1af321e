#include "bake/app/command_line.h"
#include "common/base/exit_status.h"
#include "common/base/report_failure.h"

int main(int argc, char** argv) try {
    shadowcache::installFailureHandler();
    shadowcache::BakeJob job;
    if (const auto status = shadowcache::parseArguments(argc, argv, job)) return *status;
    shadowcache::run(job);
    return shadowcache::kDone;
} catch (const std::exception& e) {
    return shadowcache::reportFailure("shadowcache-bake", e);
}
